#version 460
#extension GL_EXT_ray_tracing : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT scene;
layout(location = 0) rayPayloadInEXT vec4 payload;
layout(location = 1) rayPayloadEXT vec4 child;
hitAttributeEXT vec2 bary;
layout(shaderRecordEXT) buffer Record { vec4 tint; } record;
layout(set = 0, binding = 3) readonly buffer Vertices { vec4 v[]; } vertices;

void main() {
  const vec3 normal = normalize(vertices.v[gl_PrimitiveID].xyz);
  child = vec4(0.0);
  if (payload.w < 4.0) {
    traceRayEXT(scene, gl_RayFlagsNoneEXT, 0xff, 0, 1, 0,
                gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT, 0.001, normal, 1e4, 1);
  }
  payload = child * record.tint + vec4(bary, float(gl_GeometryIndexEXT), float(gl_InstanceID));
}
