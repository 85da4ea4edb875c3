// The first hit of a pixel's sample, for workloads that shade it from ray generation.
vec3 trace_primary(uvec2 pixel, Key key) {
  vec3 origin, direction;
  primary_ray(pixel, gl_LaunchSizeEXT.xy, key, origin, direction);
  payload.key = key;
  count_ray(kRayPrimary);
  traceRayEXT(tlas, seeing_flags(), 0xff, 0, 0, 0, origin, frame.t_min, direction, frame.t_max,
              0);
  return direction;
}

// What ray generation keeps of a hit before further rays overwrite the payload.
struct PrimaryHit {
  vec3 position, normal, color, emission;
};
PrimaryHit keep_hit() {
  PrimaryHit hit;
  hit.position = payload.origin;
  hit.normal = payload.normal;
  hit.color = materials[payload.material].kind == kMaterialGlass ? vec3(1.0) : payload.base;
  hit.emission = payload.emission;
  return hit;
}
