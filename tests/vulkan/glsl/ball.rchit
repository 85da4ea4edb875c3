#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(location = 0) rayPayloadInEXT vec3 color;
hitAttributeEXT vec3 normal;
void main() { color = normal * 0.3 + 0.4 + 0.1 * float(gl_HitKindEXT); }
