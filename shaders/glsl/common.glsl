// What every stage includes: layouts, bindings, effect switches, random numbers.
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_nonuniform_qualifier : require
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

layout(constant_id = kSpecEffects) const uint kEffects = 0xffffffffu;
layout(constant_id = kSpecCountRays) const uint kCountRays = 0;
layout(constant_id = kSpecLumibenchShadow) const uint kLumibenchShadow = 0;

// Effects are tested inside the branch that the scene's data takes, never around it: a picture and
// the instructions that draw it are the same whether an effect nobody calls for is built or not.
bool built(uint effect) { return (kEffects & effect) != 0; }

layout(set = 0, binding = kBindTlas) uniform accelerationStructureEXT tlas;
layout(set = 0, binding = kBindAccumulation, rgba32f) uniform image2D accumulation;
layout(set = 0, binding = kBindPicture, rgba8) uniform writeonly image2D picture;
layout(set = 0, binding = kBindFrame, scalar) uniform FrameBlock { Frame frame; };
layout(set = 0, binding = kBindVertices, scalar) readonly buffer Vertices { Vertex vertices[]; };
layout(set = 0, binding = kBindIndices, scalar) readonly buffer Indices { uint indices[]; };
layout(set = 0, binding = kBindGeometries, scalar) readonly buffer Geometries {
  Geometry geometries[];
};
layout(set = 0, binding = kBindMaterials, scalar) readonly buffer Materials {
  Material materials[];
};
layout(set = 0, binding = kBindShapes, scalar) readonly buffer Shapes { Shape shapes[]; };
layout(set = 0, binding = kBindLights, scalar) readonly buffer Lights { Light lights[]; };
layout(set = 0, binding = kBindEmitters, scalar) readonly buffer Emitters { Emitter emitters[]; };
layout(set = 0, binding = kBindRayCounts, scalar) buffer RayCounts { uint ray_counts[]; };
layout(set = 0, binding = kBindTextures) uniform sampler2D textures[];

const float kPi = 3.14159265358979;

// One dimension per use: what an effect draws never moves the numbers of another.
const uint kDimPixel = 0;
const uint kDimLens = 2;
const uint kDimLobe = 4;
const uint kDimScatter = 6;
const uint kDimCoat = 8;
const uint kDimLight = 16;  // 2 per light or shadow ray
const uint kDimOcclusion = 8192;

uint hash(uint x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}
uint hash_combine(uint seed, uint value) {
  return hash(seed ^ (value * 0x9e3779b9u + 0x7f4a7c15u + (seed << 6) + (seed >> 2)));
}
#include "sampler.glsl"

// Flags of rays whose hit is seen. Shadow rays are blocked from either side.
uint seeing_flags() {
  uint flags = gl_RayFlagsNoneEXT;
  if (frame.cull != 0u) {
    if (built(kEffectCulling)) {
      flags = gl_RayFlagsCullBackFacingTrianglesEXT;
    }
  }
  return flags;
}

void count_ray(uint kind) {
  if (kCountRays != 0) {
    atomicAdd(ray_counts[kind], 1u);
  }
}

// Orthonormal basis around n (Duff et al., "Building an Orthonormal Basis, Revisited", 2017).
void basis(vec3 n, out vec3 t, out vec3 b) {
  float s = n.z >= 0.0 ? 1.0 : -1.0;
  float a = -1.0 / (s + n.z);
  float c = n.x * n.y * a;
  t = vec3(1.0 + s * n.x * n.x * a, s * c, -s * n.x);
  b = vec3(c, s + n.y * n.y * a, -n.y);
}
vec3 sphere_direction(vec2 u) {
  float z = 1.0 - 2.0 * u.x;
  float r = sqrt(max(0.0, 1.0 - z * z));
  float phi = 2.0 * kPi * u.y;
  return vec3(r * cos(phi), r * sin(phi), z);
}
vec2 disc(vec2 u) {
  float r = sqrt(u.x);
  float phi = 2.0 * kPi * u.y;
  return r * vec2(cos(phi), sin(phi));
}
vec3 cosine_direction(vec3 n, vec2 u) {
  vec3 t, b;
  basis(n, t, b);
  vec2 d = disc(u);
  return normalize(t * d.x + b * d.y + n * sqrt(max(0.0, 1.0 - u.x)));
}

// Moves a point off a surface by an amount that covers the rounding of the hit point (Waechter and
// Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems, ch. 6).
vec3 leave_surface(vec3 p, vec3 n) {
  if (frame.use_offset == 0) {
    return p;
  }
  ivec3 step_by = ivec3(256.0 * n);
  vec3 moved = vec3(
      intBitsToFloat(floatBitsToInt(p.x) + (p.x < 0.0 ? -step_by.x : step_by.x)),
      intBitsToFloat(floatBitsToInt(p.y) + (p.y < 0.0 ? -step_by.y : step_by.y)),
      intBitsToFloat(floatBitsToInt(p.z) + (p.z < 0.0 ? -step_by.z : step_by.z)));
  const float near_zero = 1.0 / 32.0;
  return vec3(abs(p.x) < near_zero ? p.x + n.x / 65536.0 : moved.x,
              abs(p.y) < near_zero ? p.y + n.y / 65536.0 : moved.y,
              abs(p.z) < near_zero ? p.z + n.z / 65536.0 : moved.z);
}
