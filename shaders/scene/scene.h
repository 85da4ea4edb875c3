// The scene in memory: what the loader and the embedded scenes produce and what is drawn.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace a2rt::scene {

inline constexpr std::uint32_t kNoIndex = std::numeric_limits<std::uint32_t>::max();

enum class Wrap { kRepeat, kClamp, kMirror };

// Pixels are RGBA8, row 0 first.
struct Texture {
  std::string name;
  std::uint32_t width = 1, height = 1;
  std::vector<std::uint8_t> rgba = {255, 255, 255, 255};
  bool srgb = true;
  bool nearest = false;
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
};

// How a material scatters. The first four are LumiBench's; kPrincipled is glTF's own model.
enum class MaterialKind { kDiffuse, kMetal, kGlass, kEmissive, kPrincipled };
enum class AlphaMode { kOpaque, kMask, kBlend };

// Colours are linear. Texture fields are indices into Scene::textures or kNoIndex.
struct Material {
  std::string name;
  MaterialKind kind = MaterialKind::kDiffuse;
  glm::vec3 base_color{1};
  float alpha = 1;
  glm::vec3 emission{0};
  float metallic = 0;
  float roughness = 1;  // of kMetal: LumiBench's fuzz
  float transmission = 0;
  float ior = 1.5F;
  glm::vec3 attenuation_color{1};
  float attenuation_distance = 0;  // 0: the inside does not absorb
  float clearcoat = 0;
  float clearcoat_roughness = 0;
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  float alpha_cutoff = 0.5F;
  bool double_sided = false;  // false: seen from its front only
  bool thin = false;          // transmits without bending: a sheet, not a body
  std::uint32_t base_texture = kNoIndex;
  std::uint32_t metallic_roughness_texture = kNoIndex;
  std::uint32_t emissive_texture = kNoIndex;
  std::uint32_t normal_texture = kNoIndex;
  float normal_scale = 1;
  std::uint32_t transmission_texture = kNoIndex;         // red channel
  std::uint32_t clearcoat_texture = kNoIndex;            // red channel
  std::uint32_t clearcoat_roughness_texture = kNoIndex;  // green channel
};

// Triangles of one material. normals and uvs are empty or as long as positions.
struct Primitive {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec2> uvs;
  std::vector<std::uint32_t> indices;  // three a triangle, all below positions.size()
  std::uint32_t material = 0;
};

// One bottom-level structure: primitives, or procedural shapes of one kind.
struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;
};

enum class ShapeKind { kSphere, kBox };
struct Shape {
  glm::vec3 centre{0};
  glm::vec3 half_extent{1};  // sphere: x is the radius
  std::uint32_t material = 0;
};
struct ShapeSet {
  std::string name;
  ShapeKind kind = ShapeKind::kSphere;
  std::vector<Shape> shapes;
};

// A mesh or a shape set placed in the world.
struct Instance {
  std::string name;
  std::uint32_t mesh = kNoIndex;       // index into Scene::meshes ...
  std::uint32_t shape_set = kNoIndex;  // ... or into Scene::shape_sets
  glm::dmat4 transform{1};
};

enum class LightKind { kDirectional, kPoint, kSpot, kSphere };
struct Light {
  std::string name;
  LightKind kind = LightKind::kDirectional;
  glm::vec3 color{1};            // intensity included: lux (directional) or candela
  glm::vec3 position{0};         // all but directional
  glm::vec3 direction{0, 1, 0};  // directional: towards the light; spot: the way it shines
  float radius = 0;              // emitting sphere; directional: tangent of the half angle
  float range = 0;               // 0: unlimited
  float inner_angle = 0, outer_angle = 0.785398F;  // spot, radians
};

struct Camera {
  std::string name;
  glm::vec3 eye{0, 0, 1};
  glm::vec3 forward{0, 0, -1};    // unit
  glm::vec3 up{0, 1, 0};          // not parallel to forward
  float vertical_fov = 0.8F;      // radians, in (0, pi); ignored if orthographic
  float orthographic_height = 0;  // full height of the view; 0: perspective
  float aperture = 0;             // diameter of the lens
  float focus_distance = 1;
};

struct Sky {
  bool present = false;
  glm::vec3 bottom{1}, top{0.5F, 0.7F, 1.0F};
};

struct Bounds {
  glm::vec3 lo{std::numeric_limits<float>::infinity()};
  glm::vec3 hi{-std::numeric_limits<float>::infinity()};
  bool valid() const { return lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z; }
  void include(const glm::vec3& p);
  glm::vec3 centre() const { return 0.5F * lo + 0.5F * hi; }
  float diagonal() const;
};

struct Scene {
  std::string name;
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<ShapeSet> shape_sets;
  std::vector<Instance> instances;
  std::vector<Light> lights;
  std::vector<Camera> cameras;  // the first is the default; empty: frame automatically
  Sky sky;
  // Towards the light of the shadow workload when the scene has no light of its own.
  glm::vec3 sun_direction{0.357771F, 0.894427F, 0.268328F};
  bool lumibench = false;  // carries LumiBench's extras: its constants (ray interval, AO) apply
  std::uint64_t inactive_triangles = 0;  // left out: a vertex was not finite
  std::vector<std::string> warnings;     // what was read but not honoured, one line each
};

struct Counts {
  std::uint64_t triangles = 0;        // stored once per mesh
  std::uint64_t drawn_triangles = 0;  // counted once per instance
  std::uint64_t vertices = 0, shapes = 0, meshes = 0, primitives = 0, instances = 0;
};
Counts count(const Scene& scene);

// World bounds of everything drawn.
Bounds world_bounds(const Scene& scene);

// Throws UserError naming the place if an index is out of range, a value is not finite where it
// must be, or nothing is left to draw. Every scene passes here before it is drawn, whatever its
// origin.
void validate(const Scene& scene);

}  // namespace a2rt::scene
