// Two queries in one array, one of them reached by a computed index.
#version 460
#extension GL_EXT_ray_query : require
layout(local_size_x = 8) in;
layout(set = 0, binding = 0) uniform accelerationStructureEXT scene;
layout(set = 0, binding = 1) buffer Out { uint hits[]; } result;

void main() {
  rayQueryEXT queries[2];
  for (uint i = 0; i < 2; ++i) {
    rayQueryInitializeEXT(queries[i], scene, 0, 0xff, vec3(float(i)), 0.0, vec3(1.0), 10.0);
    rayQueryProceedEXT(queries[i]);
  }
  rayQueryProceedEXT(queries[1]);
  result.hits[gl_LocalInvocationIndex] = rayQueryGetIntersectionTypeEXT(queries[1], true);
}
