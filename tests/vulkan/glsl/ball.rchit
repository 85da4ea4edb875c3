#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(location = 0) rayPayloadInEXT vec3 color;
void main() {
  // Not the hit attribute: lavapipe lets a rejected intersection overwrite it, so that it would
  // depend on the order of traversal.
  vec3 place = gl_ObjectRayOriginEXT + gl_ObjectRayDirectionEXT * gl_HitTEXT;
  vec3 center = vec3(more[gl_PrimitiveID * 4], more[gl_PrimitiveID * 4 + 1],
                     more[gl_PrimitiveID * 4 + 2]);
  color = normalize(place - center) * 0.3 + 0.4 + 0.1 * float(gl_HitKindEXT);
}
