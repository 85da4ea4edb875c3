#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 1) rayPayloadEXT vec3 nested;
layout(push_constant) uniform Constants { uint hit_offset; uint frame; };
hitAttributeEXT vec2 place;
void main() {
  vec3 own = hash_color(gl_PrimitiveID) * 0.5 + vec3(place, 0) * 0.1;
  nested = vec3(0);
  vec3 start = gl_WorldRayOriginEXT + gl_WorldRayDirectionEXT * gl_HitTEXT;
  vec3 direction = reflect(gl_WorldRayDirectionEXT, normalize(vec3(0.2, 0.1, 1.0)));
  traceRayEXT(scene, gl_RayFlagsNoneEXT, 0xff, 1, 1, 1, start, 0.01, direction, 50.0, 1);
  color = own + 0.5 * nested;
}
