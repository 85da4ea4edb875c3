// LumiBench's shadow test: the colour loses a factor for every ray towards the light that is
// blocked. The light is the scene's first one, else a sun from a fixed direction.

// Number of blocked rays of `rays`; rays that leave below the surface count as blocked, untraced.
uint blocked_towards_light(PrimaryHit hit, Key key, uint rays) {
  uint count = 0u;
  for (uint i = 0u; i < rays; ++i) {
    vec2 u = random2(key, kDimLight + 4u + 2u * i);
    vec3 direction = frame.sun_direction;
    float reach = frame.t_max;
    if (frame.light_count > 0u) {
      Light light = lights[0];
      if (light.kind == kLightDirectional) {
        direction = light.direction;
        if (light.radius > 0.0) {
          if (built(kEffectSoftShadow)) {
            direction = cone_direction(light.direction, light.radius, u);
          }
        }
      } else {
        vec3 target = light.position;
        if (light.radius > 0.0) {
          if (built(kEffectSoftShadow)) {
            target += light.radius * sphere_direction(u) *
                      pow(random(key, kDimLight + 1024u + i), 1.0 / 3.0);
          }
        }
        reach = length(target - hit.position);
        direction = (target - hit.position) / reach;
      }
    } else if (frame.emitter_count * frame.light_sampling > 0u) {
      if (built(kEffectSoftShadow)) {
        vec3 target = emitter_point(random(key, kDimLight + 1024u + i), u);
        reach = length(target - hit.position) * 0.9999;
        direction = normalize(target - hit.position);
      }
    }
    bool dark = dot(direction, hit.normal) <= 0.0;
    if (!dark) {
      if (built(kEffectShadow | kEffectSoftShadow)) {
        dark = blocked(hit.position, direction, reach, kRayShadow);
      }
    }
    count += dark ? 1u : 0u;
  }
  return count;
}
