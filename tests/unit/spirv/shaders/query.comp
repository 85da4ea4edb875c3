#version 460
#extension GL_EXT_ray_query : require
layout(local_size_x = 8, local_size_y = 4) in;
layout(set = 1, binding = 0) uniform accelerationStructureEXT scene;
layout(set = 0, binding = 1) buffer Out { vec4 hits[]; } result;

void main() {
  rayQueryEXT query;
  rayQueryInitializeEXT(query, scene, gl_RayFlagsNoneEXT, 0x3f, vec3(gl_GlobalInvocationID), 0.0,
                        vec3(0.0, 0.0, 1.0), 100.0);
  uint steps = 0;
  while (rayQueryProceedEXT(query)) {
    ++steps;
    if (rayQueryGetIntersectionTypeEXT(query, false) ==
        gl_RayQueryCandidateIntersectionTriangleEXT) {
      if (rayQueryGetIntersectionBarycentricsEXT(query, false).x > 0.5) {
        rayQueryConfirmIntersectionEXT(query);
      }
    } else {
      rayQueryGenerateIntersectionEXT(query, 3.0);
    }
    if (steps > 10) {
      rayQueryTerminateEXT(query);
    }
  }
  if (rayQueryGetIntersectionTypeEXT(query, true) != gl_RayQueryCommittedIntersectionNoneEXT) {
    result.hits[gl_LocalInvocationIndex] = vec4(rayQueryGetIntersectionTEXT(query, true));
  }
}
