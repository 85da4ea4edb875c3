#version 460
#extension GL_EXT_ray_query : require
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "query.glsl"
// The width of a group is a specialization constant: the layer must read it from the pipeline.
layout(local_size_x_id = 0, local_size_y = 4) in;
void main() {
  uvec2 size = gl_NumWorkGroups.xy * gl_WorkGroupSize.xy;
  uvec2 pixel = gl_GlobalInvocationID.xy;
  pixels[pixel.y * size.x + pixel.x] = pack(query_color(pixel, size));
}
