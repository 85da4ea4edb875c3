#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(location = 0) rayPayloadInEXT vec3 color;
layout(shaderRecordEXT, std430) buffer Record { uint number; };
void main() { color = hash_color(number * 31u) * 0.5 + hash_color(gl_PrimitiveID) * 0.4; }
