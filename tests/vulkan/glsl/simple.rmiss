#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(location = 0) rayPayloadInEXT vec3 color;
void main() { color = vec3(0.5 + 0.5 * gl_WorldRayDirectionEXT.y, 0.6, 0.9); }
