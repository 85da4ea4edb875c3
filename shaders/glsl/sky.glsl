// Sky colour by height, as LumiBench's miss shader.
vec3 sky(vec3 d) {
  vec3 colour = vec3(0.0);
  if (frame.sky_bottom != vec3(0.0) || frame.sky_top != vec3(0.0)) {
    if (built(kEffectSky)) {
      colour = mix(frame.sky_bottom, frame.sky_top, 0.5 * (d.y + 1.0));
    }
  }
  return colour;
}
