// The workgroup size is a specialization constant, the flags depend on one, and the structure comes
// from an address.
#version 460
#extension GL_EXT_ray_query : require
#extension GL_EXT_ray_tracing : require
layout(local_size_x_id = 0, local_size_y_id = 1) in;
layout(constant_id = 5) const uint kExtraFlags = 4;
layout(push_constant) uniform Push { uvec2 scene; } push;
layout(set = 0, binding = 1) buffer Out { uint hits; } result;

rayQueryEXT query;

bool occluded(vec3 from) {
  rayQueryInitializeEXT(query, accelerationStructureEXT(push.scene),
                        kExtraFlags | gl_RayFlagsOpaqueEXT, 0xff, from, 0.0, vec3(1.0), 100.0);
  rayQueryProceedEXT(query);
  return rayQueryGetIntersectionTypeEXT(query, true) != 0;
}
void main() {
  if (occluded(vec3(0.0))) {
    atomicAdd(result.hits, 1);
  }
}
