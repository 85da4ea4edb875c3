#version 460
#extension GL_EXT_ray_query : require
layout(local_size_x = 2, local_size_y = 3) in;
layout(set = 0, binding = 0) uniform accelerationStructureEXT scene;

void main() {
  const vec3 from = vec3(0.5 + 2.0 * float(gl_GlobalInvocationID.x), -0.5, 0.0);
  rayQueryEXT query;
  rayQueryInitializeEXT(query, scene, gl_RayFlagsNoneEXT, 0xff, from, 0.25, vec3(0.0, 0.0, 1.0),
                        100.0);
  while (rayQueryProceedEXT(query)) {
    if (gl_GlobalInvocationID.y == 2) {
      rayQueryTerminateEXT(query);
    } else if (gl_GlobalInvocationID.y == 0) {
      if (rayQueryGetIntersectionTypeEXT(query, false) ==
          gl_RayQueryCandidateIntersectionTriangleEXT) {
        rayQueryConfirmIntersectionEXT(query);
      } else {
        rayQueryGenerateIntersectionEXT(query, 5.25);
      }
    }
  }
}
