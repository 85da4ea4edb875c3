// Data layouts and numbers that GLSL and C++ share; compiled as both, so they cannot drift.
// GLSL side: scalar block layout (GL_EXT_scalar_block_layout), which packs as C++ packs these
// types.
#ifndef A2RT_SHADERS_SHARED_H
#define A2RT_SHADERS_SHARED_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace a2rt::gpu {
using uint = std::uint32_t;
using glm::vec2;
using glm::vec3;
using glm::vec4;
#define A2RT_CONST inline constexpr
#else
#define A2RT_CONST const
#endif

// Bindings of descriptor set 0.
A2RT_CONST uint kBindTlas = 0;
A2RT_CONST uint kBindAccumulation = 1;
A2RT_CONST uint kBindPicture = 2;
A2RT_CONST uint kBindFrame = 3;
A2RT_CONST uint kBindVertices = 4;
A2RT_CONST uint kBindIndices = 5;
A2RT_CONST uint kBindGeometries = 6;
A2RT_CONST uint kBindMaterials = 7;
A2RT_CONST uint kBindShapes = 8;
A2RT_CONST uint kBindLights = 9;
A2RT_CONST uint kBindEmitters = 10;
A2RT_CONST uint kBindRayCounts = 11;
A2RT_CONST uint kBindTextures = 12;
A2RT_CONST uint kBindings = 13;

// Effects, as bits of specialization constant kSpecEffects. A cleared bit removes the code.
A2RT_CONST uint kEffectShadow = 1u << 0;
A2RT_CONST uint kEffectSoftShadow = 1u << 1;
A2RT_CONST uint kEffectAmbientOcclusion = 1u << 2;
A2RT_CONST uint kEffectMirror = 1u << 3;
A2RT_CONST uint kEffectRough = 1u << 4;
A2RT_CONST uint kEffectRefraction = 1u << 5;
A2RT_CONST uint kEffectDiffuse = 1u << 6;
A2RT_CONST uint kEffectEmission = 1u << 7;
A2RT_CONST uint kEffectSky = 1u << 8;
A2RT_CONST uint kEffectAlpha = 1u << 9;
A2RT_CONST uint kEffectProcedural = 1u << 10;
A2RT_CONST uint kEffectInstancing = 1u << 11;
A2RT_CONST uint kEffectTextures = 1u << 12;
A2RT_CONST uint kEffectNormals = 1u << 13;
A2RT_CONST uint kEffectClearcoat = 1u << 14;
A2RT_CONST uint kEffectVolume = 1u << 15;
A2RT_CONST uint kEffectNormalMaps = 1u << 16;
A2RT_CONST uint kEffectCulling = 1u << 17;

// Specialization constants.
A2RT_CONST uint kSpecEffects = 0;
A2RT_CONST uint kSpecCountRays = 1;
A2RT_CONST uint kSpecLumibenchShadow = 2;

// Ray kinds, counted when asked for.
A2RT_CONST uint kRayPrimary = 0;
A2RT_CONST uint kRayBounce = 1;  // from a diffuse hit
A2RT_CONST uint kRayShadow = 2;
A2RT_CONST uint kRayOcclusion = 3;
A2RT_CONST uint kRayReflection = 4;
A2RT_CONST uint kRayRefraction = 5;
A2RT_CONST uint kRayKinds = 6;

struct Vertex {
  vec3 position;
  vec3 normal;
  vec2 uv;
};

// One geometry of a bottom-level structure; the instance's custom index is that of its first.
struct Geometry {
  uint first_index;   // into the index buffer; for shapes: first entry of the shape buffer
  uint first_vertex;  // added to every index
  uint material;      // unused for shapes, which carry their own
  uint flags;         // kGeometry*
};
A2RT_CONST uint kGeometrySmooth = 1u;  // vertices carry shading normals
A2RT_CONST uint kGeometryAlpha = 2u;   // the any-hit shader has to look at it
A2RT_CONST uint kGeometryNormalMap = 4u;

// Material kinds. The first four follow LumiBench's shaders; kPrincipled is glTF's own model.
A2RT_CONST uint kMaterialDiffuse = 0;
A2RT_CONST uint kMaterialMetal = 1;
A2RT_CONST uint kMaterialGlass = 2;
A2RT_CONST uint kMaterialEmissive = 3;
A2RT_CONST uint kMaterialPrincipled = 4;

A2RT_CONST uint kAlphaOpaque = 0;
A2RT_CONST uint kAlphaMask = 1;
A2RT_CONST uint kAlphaBlend = 2;

struct Material {
  vec3 base_color;
  float alpha;
  vec3 emission;
  float alpha_cutoff;
  vec3 attenuation_color;
  float attenuation_distance;  // 0: the inside does not absorb
  float metallic;
  float roughness;  // of kMaterialMetal: the fuzz radius
  float transmission;
  float ior;
  float clearcoat;
  float clearcoat_roughness;
  uint kind;
  uint alpha_mode;
  int base_texture;  // -1: none
  int metallic_roughness_texture;
  int emissive_texture;
  uint single_sided;  // emits from its front only
  int normal_texture;
  float normal_scale;
  int transmission_texture;
  int clearcoat_texture;
  int clearcoat_roughness_texture;
  uint thin;  // 1: transmits without bending
};

// A procedural sphere (centre, half_extent.x = radius) or axis-aligned box (centre, half_extent).
struct Shape {
  vec3 centre;
  vec3 half_extent;
  uint material;
};

A2RT_CONST uint kLightDirectional = 0;
A2RT_CONST uint kLightPoint = 1;
A2RT_CONST uint kLightSpot = 2;
A2RT_CONST uint kLightSphere = 3;  // LumiBench's light: for the shadow workload only

struct Light {
  vec3 color;  // intensity included: lux for directional lights, candela for the others
  uint kind;
  vec3 position;
  float radius;    // of the emitting sphere; directional: tangent of the half angle; 0: sharp
  vec3 direction;  // directional: towards the light; spot: the way it shines
  float range;     // 0: unlimited
  float cos_inner;
  float cos_outer;
};

// A triangle that emits, for light sampling.
struct Emitter {
  vec3 origin;
  vec3 edge1;
  vec3 edge2;
  vec3 emission;
  float cumulative;  // share of the emitted power of all emitters up to this one, 1 at the last
  float probability;
  uint single_sided;  // 1: shines along edge1 x edge2 only
};

struct Frame {
  vec3 eye;
  float aperture_radius;
  vec3 forward;  // of length focus distance
  float t_min;
  vec3 right;  // half width of the picture at the focus distance
  float t_max;
  vec3 up;             // half height
  float orthographic;  // 1: rays start on the picture plane
  vec3 sky_bottom;
  float ao_distance;
  vec3 sky_top;
  float shadow_factor;
  vec3 sun_direction;  // of the shadow workload when the scene has no light
  float ao_factor;
  vec3 sun_radiance;  // seen inside the cone around light 0 when it is a soft directional light
  float sun_cos;      // 2: no visible sun
  uint seed;
  uint first_sample;
  uint samples;
  uint max_bounces;
  uint shadow_rays;
  uint ao_rays;
  uint light_count;
  uint emitter_count;
  uint light_sampling;  // 1: emitters are sampled by shadow rays
  uint use_offset;      // 1: secondary origins leave the surface by a few ulps before t_min counts
  float exposure;
  float clamp_indirect;  // most a sample may add after its first diffuse hit; 0: no limit
  uint sample_bits;      // samples of a pixel are numbered below 2^sample_bits
  uint cull;             // 1: rays of light that is seen pass the backs of single-sided triangles
};

#ifdef __cplusplus
static_assert(sizeof(Vertex) == 32 && sizeof(Geometry) == 16 && sizeof(Material) == 120);
static_assert(sizeof(Shape) == 28 && sizeof(Light) == 56 && sizeof(Emitter) == 60);
}  // namespace a2rt::gpu
#endif

#endif
