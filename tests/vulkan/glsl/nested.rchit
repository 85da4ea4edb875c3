#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(location = 1) rayPayloadInEXT vec3 nested;
layout(location = 2) rayPayloadEXT vec3 last;
void main() {
  // Read before the trace: lavapipe forgets gl_PrimitiveID of the parent over a nested trace.
  vec3 own = hash_color(gl_PrimitiveID + 5u) * 0.5;
  last = vec3(0);
  vec3 start = gl_WorldRayOriginEXT + gl_WorldRayDirectionEXT * gl_HitTEXT;
  traceRayEXT(scene, gl_RayFlagsOpaqueEXT | gl_RayFlagsTerminateOnFirstHitEXT, 0xff, 2, 1, 2, start,
              0.01, vec3(0.1, 1, 0.2), 50.0, 2);
  nested = own + last;
}
