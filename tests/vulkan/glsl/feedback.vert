#version 460
#extension GL_EXT_ray_query : require
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "query.glsl"
layout(xfb_buffer = 0, xfb_stride = 16) out;
out gl_PerVertex {
  layout(xfb_offset = 0) vec4 gl_Position;
};
// A triangle over the whole picture; its depth is what a ray of the vertex found.
void main() {
  vec2 corner = vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2);
  vec3 seen = query_color(uvec2(20 + 20 * gl_VertexIndex, 32), uvec2(96, 64));
  gl_Position = vec4(corner * 2.0 - 1.0, 0.5 * seen.x, 1.0);
}
