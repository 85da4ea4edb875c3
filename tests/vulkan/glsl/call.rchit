#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 0) callableDataEXT vec3 data;
void main() {
  data = vec3(gl_PrimitiveID, gl_HitTEXT, 1.0);
  executeCallableEXT(gl_PrimitiveID & 1, 0);
  color = data;
}
