#version 460
#extension GL_EXT_ray_query : require
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "query.glsl"
layout(location = 0) out vec4 color;
void main() { color = vec4(query_color(uvec2(gl_FragCoord.xy), uvec2(96, 64)), 1); }
