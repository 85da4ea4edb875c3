#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(location = 1) rayPayloadInEXT vec3 nested;
void main() { nested = vec3(0.3, 0.2, 0.1); }
