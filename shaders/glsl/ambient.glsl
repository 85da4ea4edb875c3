// Local shading of a diffuse point without further bounces: direct light, and the sky (or a faint
// constant where there is none) in place of what bounces would bring.
vec3 local_light(vec3 position, vec3 normal, Key key) {
  vec3 zenith = frame.sky_top * 0.5 * (normal.y + 1.0) + frame.sky_bottom * 0.5 * (1.0 - normal.y);
  vec3 ambient = zenith == vec3(0.0) ? vec3(0.12) : zenith;
  float open_sky = 1.0;
  if (frame.light_count == 0u && frame.emitter_count * frame.light_sampling == 0u) {
    // No light to cast a shadow: the sun of the shadow workload does.
    if (built(kEffectShadow)) {
      bool dark = dot(normal, frame.sun_direction) <= 0.0 ||
                  blocked(position, frame.sun_direction, frame.t_max, kRayShadow);
      open_sky = dark ? 0.35 : 1.0;
    }
    return ambient * open_sky;
  }
  return ambient * 0.6 + direct_light(position, normal, key);
}
