#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(location = 2) rayPayloadInEXT vec3 last;
void main() { last = vec3(0.1); }
