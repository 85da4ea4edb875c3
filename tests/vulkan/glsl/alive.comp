#version 460
#extension GL_EXT_ray_query : require
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
// Several queries alive at once: an outer one, and two in an array that a function steps. Their
// intervals do not overlap, so the hits of one cannot be those of another.
layout(local_size_x = 8, local_size_y = 4) in;

bool advance(rayQueryEXT query) { return rayQueryProceedEXT(query); }

void begin(rayQueryEXT query, vec3 direction, float back) {
  rayQueryInitializeEXT(query, scene, gl_RayFlagsOpaqueEXT, 0xff, kCamera - back * direction,
                        back - 10.0, direction, back + 40.0);
}

void main() {
  uvec2 pixel = gl_GlobalInvocationID.xy;
  vec3 direction = camera_direction(pixel, uvec2(96, 64));
  rayQueryEXT outer, inner;
  rayQueryEXT pair[2];
  float sum = 0;
  for (uint i = 0; i < 2; ++i) {
    rayQueryInitializeEXT(pair[i], scene, gl_RayFlagsOpaqueEXT, 0xff,
                          kCamera - (100.0 + 50.0 * i) * direction, 90.0 + 50.0 * i, direction,
                          140.0 + 50.0 * i);
  }
  rayQueryInitializeEXT(outer, scene, gl_RayFlagsNoOpaqueEXT, 0xff, kCamera, 0.001, direction,
                        40.0);
  while (advance(outer)) {
    begin(inner, direction, 60.0);
    while (advance(inner)) {}
    sum += rayQueryGetIntersectionTEXT(inner, true);
    if (fract(sum * 37.0) < 0.6) {
      rayQueryConfirmIntersectionEXT(outer);
    }
  }
  for (uint i = 0; i < 2; ++i) {
    rayQueryProceedEXT(pair[(i + pixel.x) & 1]);
  }
  vec3 found;
  found.x = rayQueryGetIntersectionTypeEXT(outer, true) != 0 ? fract(sum) : 0.0;
  for (uint i = 0; i < 2; ++i) {
    found[1 + i] = rayQueryGetIntersectionTypeEXT(pair[i], true) != 0
                       ? fract(rayQueryGetIntersectionTEXT(pair[i], true))
                       : 0.5;
  }
  pixels[pixel.y * 96 + pixel.x] = pack(found);
}
