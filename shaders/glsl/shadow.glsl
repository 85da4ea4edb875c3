// Rays that only ask whether something is in the way. Needs `payload` (location 0).
layout(location = 1) rayPayloadEXT uint occluded;

// By default such a ray ends at the first hit and runs no closest-hit shader. LumiBench leaves the
// closest-hit shader on, which shades every occluder in vain; kLumibenchShadow reproduces that.
bool blocked(vec3 origin, vec3 direction, float t_max, uint kind) {
  count_ray(kind);
  if (kLumibenchShadow != 0) {
    traceRayEXT(tlas, gl_RayFlagsTerminateOnFirstHitEXT, 0xff, 0, 0, 0, origin, frame.t_min,
                direction, t_max, 0);
    return payload.t > 0.0;
  }
  occluded = 1;
  traceRayEXT(tlas, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xff, 0,
              0, 1, origin, frame.t_min, direction, t_max, 1);
  return occluded != 0;
}
