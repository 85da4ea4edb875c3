#version 460
#extension GL_EXT_ray_query : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT scene;
layout(location = 0) in vec3 normal;
layout(location = 0) out vec4 colour;

void main() {
  if (normal.z < 0.0) {
    discard;
  }
  rayQueryEXT query;
  rayQueryInitializeEXT(query, scene, gl_RayFlagsTerminateOnFirstHitEXT, 0xff, normal, 0.0, normal,
                        100.0);
  rayQueryProceedEXT(query);
  colour = vec4(float(rayQueryGetIntersectionTypeEXT(query, true)));
}
