#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(location = 0) rayPayloadInEXT vec3 color;
hitAttributeEXT vec2 place;
void main() {
  uint id = gl_PrimitiveID + 131u * gl_GeometryIndexEXT + 1009u * gl_InstanceCustomIndexEXT;
  color = hash_color(id) * (0.3 + 0.2 * place.x) + vec3(0.1 * place.y) + 0.1 * fract(gl_HitTEXT);
  color += gl_HitKindEXT == gl_HitKindFrontFacingTriangleEXT ? vec3(0.2, 0, 0) : vec3(0, 0, 0.2);
}
