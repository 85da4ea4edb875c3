// A ray query whose only effect is the fragment's color.
#version 460
#extension GL_EXT_ray_query : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT scene;
layout(location = 0) out vec4 color;

void main() {
  rayQueryEXT query;
  rayQueryInitializeEXT(query, scene, 0, 0xff, vec3(gl_FragCoord.xy, 0.0), 0.0, vec3(1.0), 10.0);
  rayQueryProceedEXT(query);
  color = vec4(float(rayQueryGetIntersectionTypeEXT(query, true)));
}
