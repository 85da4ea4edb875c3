// A scene as the tables that shaders read.
#pragma once

#include <optional>
#include <vector>

#include "effects/analysis.h"
#include "glsl/shared.h"
#include "scene/scene.h"

namespace a2rt::render {

// One bottom-level structure and the geometries it owns.
struct PackedBlas {
  std::uint32_t first_geometry = 0, geometry_count = 0;
  bool procedural = false;
  scene::ShapeKind shape_kind = scene::ShapeKind::kSphere;
};
// triangle_count and vertex_count of a geometry; for shapes triangle_count is the number of shapes.
struct PackedRange {
  std::uint32_t triangle_count = 0, vertex_count = 0;
  bool opaque = true;
};
struct PackedInstance {
  std::uint32_t blas = 0;
  glm::mat4 transform{1};
  bool culled = false;  // rays may pass the backs of its triangles
};

struct PackedScene {
  std::vector<gpu::Vertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<gpu::Geometry> geometries;
  std::vector<PackedRange> ranges;  // one per geometry
  std::vector<gpu::Material> materials;
  std::vector<gpu::Shape> shapes;
  std::vector<gpu::Light> lights;
  std::vector<gpu::Emitter> emitters;
  std::vector<PackedBlas> blas;
  std::vector<PackedInstance> instances;
};

// Meshes drawn once are baked into world space, so that only shared ones need a ray transform.
// Without the instancing effect every mesh is baked; without procedural, shapes are left out;
// without alpha, all geometry is opaque. `opaque_by_material`: false offers every triangle to the
// any-hit shader.
PackedScene pack(const scene::Scene& scene, const effects::Choice& choice, bool opaque_by_material);

}  // namespace a2rt::render
