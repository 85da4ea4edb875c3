// Seven sines, one recursive ray that misses, one square root.
#version 460
#extension GL_EXT_ray_tracing : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT scene;
layout(location = 0) rayPayloadInEXT float depth;
layout(location = 1) rayPayloadEXT float child;

void main() {
  float s = depth;
  for (int i = 0; i < 7; ++i) {
    s = sin(s);
  }
  child = s + 1.0;
  traceRayEXT(scene, gl_RayFlagsOpaqueEXT, 0xff, 0, 0, 0, vec3(0.0, 50.0, 0.0), 0.0,
              vec3(0.0, 1.0, 0.0), 10.0, 1);
  depth = sqrt(child);
}
