#include "render/packed_scene.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <map>

#include "a2rt/base/error.h"

namespace a2rt::render {
namespace {

using scene::kNoIndex;
using scene::Scene;

int texture_slot(std::uint32_t index) { return index == kNoIndex ? -1 : static_cast<int>(index); }

gpu::Material pack_material(const scene::Material& m, bool holes) {
  gpu::Material g{};
  g.base_color = m.base_color;
  g.alpha = m.alpha;
  g.emission = m.emission;
  g.alpha_cutoff = m.alpha_cutoff;
  g.attenuation_color = m.attenuation_color;
  g.attenuation_distance = m.attenuation_distance;
  g.metallic = m.metallic;
  g.roughness = m.roughness;
  g.transmission = m.transmission;
  g.ior = m.ior;
  g.clearcoat = m.clearcoat;
  g.clearcoat_roughness = m.clearcoat_roughness;
  g.kind = static_cast<std::uint32_t>(m.kind);
  g.alpha_mode = holes ? static_cast<std::uint32_t>(m.alpha_mode) : gpu::kAlphaOpaque;
  g.base_texture = texture_slot(m.base_texture);
  g.metallic_roughness_texture = texture_slot(m.metallic_roughness_texture);
  g.emissive_texture = texture_slot(m.emissive_texture);
  g.single_sided = m.double_sided ? 0 : 1;
  g.normal_texture = texture_slot(m.normal_texture);
  g.normal_scale = m.normal_scale;
  g.transmission_texture = texture_slot(m.transmission_texture);
  g.clearcoat_texture = texture_slot(m.clearcoat_texture);
  g.clearcoat_roughness_texture = texture_slot(m.clearcoat_roughness_texture);
  g.thin = m.thin ? 1 : 0;
  return g;
}

class Packer {
 public:
  Packer(const Scene& scene, const effects::Choice& choice, bool opaque_by_material)
      : scene_(scene), choice_(choice), opaque_by_material_(opaque_by_material) {}

  PackedScene run() {
    for (const scene::Material& m : scene_.materials) {
      const bool holes = choice_.has(gpu::kEffectAlpha) && effects::has_holes(scene_, m);
      out_.materials.push_back(pack_material(m, holes));
    }
    std::vector<std::uint32_t> uses(scene_.meshes.size(), 0);
    for (const scene::Instance& instance : scene_.instances) {
      if (instance.mesh != kNoIndex) {
        ++uses[instance.mesh];
      }
    }
    for (const scene::Instance& instance : scene_.instances) {
      if (instance.mesh != kNoIndex) {
        place_mesh(instance, uses[instance.mesh]);
      } else if (choice_.has(gpu::kEffectProcedural)) {
        place_shapes(instance);
      }
    }
    A2RT_CHECK(out_.vertices.size() < kNoIndex && out_.indices.size() < kNoIndex,
               "more vertices or indices than 32 bits can number");
    pack_lights();
    finish_emitters();
    return std::move(out_);
  }

 private:
  void place_mesh(const scene::Instance& instance, std::uint32_t uses) {
    const scene::Mesh& mesh = scene_.meshes[instance.mesh];
    // Culling is a property of instances, so a mesh with both kinds of triangles becomes two.
    for (const bool culled : {false, true}) {
      place_side(instance, mesh, uses, culled);
    }
    add_emitters(mesh, instance.transform);
  }

  bool on_side(const scene::Primitive& p, bool culled) const {
    const bool culls =
        choice_.uses(gpu::kEffectCulling) && effects::culls(scene_.materials[p.material]);
    return !p.indices.empty() && culls == culled;
  }

  void place_side(const scene::Instance& instance, const scene::Mesh& mesh, std::uint32_t uses,
                  bool culled) {
    const bool any = std::any_of(mesh.primitives.begin(), mesh.primitives.end(),
                                 [&](const scene::Primitive& p) { return on_side(p, culled); });
    if (!any) {
      return;
    }
    const bool bake = uses == 1 || !choice_.has(gpu::kEffectInstancing);
    std::uint32_t blas = 0;
    if (bake) {
      blas = add_mesh(mesh, instance.transform, culled);
    } else {
      const std::pair key(instance.mesh, culled);
      const auto known = shared_.find(key);
      blas = known != shared_.end() ? known->second : add_mesh(mesh, glm::dmat4(1), culled);
      shared_.emplace(key, blas);
    }
    out_.instances.push_back({blas, bake ? glm::mat4(1) : glm::mat4(instance.transform), culled});
  }

  std::uint32_t add_mesh(const scene::Mesh& mesh, const glm::dmat4& transform, bool culled) {
    PackedBlas blas;
    blas.first_geometry = static_cast<std::uint32_t>(out_.geometries.size());
    for (const scene::Primitive& p : mesh.primitives) {
      if (on_side(p, culled)) {
        add_primitive(p, transform);
        ++blas.geometry_count;
      }
    }
    out_.blas.push_back(blas);
    return static_cast<std::uint32_t>(out_.blas.size() - 1);
  }

  void add_primitive(const scene::Primitive& p, const glm::dmat4& transform) {
    const bool identity = transform == glm::dmat4(1);
    const glm::dmat3 linear(transform);
    const double determinant = glm::determinant(linear);
    const bool smooth = !p.normals.empty() && (identity || std::abs(determinant) > 0);
    const glm::dmat3 to_normal =
        smooth && !identity ? glm::transpose(glm::inverse(linear)) : glm::dmat3(1);
    gpu::Geometry g{};
    g.first_index = static_cast<std::uint32_t>(out_.indices.size());
    g.first_vertex = static_cast<std::uint32_t>(out_.vertices.size());
    g.material = p.material;
    const bool holes = out_.materials[p.material].alpha_mode != gpu::kAlphaOpaque;
    const bool mapped = scene_.materials[p.material].normal_texture != kNoIndex;
    g.flags = (smooth ? gpu::kGeometrySmooth : 0U) | (holes ? gpu::kGeometryAlpha : 0U) |
              (mapped ? gpu::kGeometryNormalMap : 0U);
    for (std::size_t i = 0; i < p.positions.size(); ++i) {
      gpu::Vertex v{};
      v.position = identity ? p.positions[i]
                            : glm::vec3(transform * glm::dvec4(glm::dvec3(p.positions[i]), 1));
      if (smooth) {
        const glm::dvec3 n = to_normal * glm::dvec3(p.normals[i]);
        const double length = glm::length(n);
        v.normal = length > 0 ? glm::vec3(n / length) : p.normals[i];
      }
      v.uv = p.uvs.empty() ? glm::vec2(0) : p.uvs[i];
      out_.vertices.push_back(v);
    }
    // A baked mirror image keeps its front only if its triangles turn the other way.
    const bool flip = determinant < 0;
    for (std::size_t i = 0; i < p.indices.size(); i += 3) {
      out_.indices.push_back(p.indices[i]);
      out_.indices.push_back(p.indices[i + (flip ? 2 : 1)]);
      out_.indices.push_back(p.indices[i + (flip ? 1 : 2)]);
    }
    out_.geometries.push_back(g);
    out_.ranges.push_back({static_cast<std::uint32_t>(p.indices.size() / 3),
                           static_cast<std::uint32_t>(p.positions.size()),
                           !holes && (opaque_by_material_ || !choice_.has(gpu::kEffectAlpha))});
  }

  void place_shapes(const scene::Instance& instance) {
    const scene::ShapeSet& set = scene_.shape_sets[instance.shape_set];
    if (set.shapes.empty()) {
      return;
    }
    auto known = shared_shapes_.find(instance.shape_set);
    if (known == shared_shapes_.end()) {
      PackedBlas blas;
      blas.first_geometry = static_cast<std::uint32_t>(out_.geometries.size());
      blas.geometry_count = 1;
      blas.procedural = true;
      blas.shape_kind = set.kind;
      out_.geometries.push_back({static_cast<std::uint32_t>(out_.shapes.size()), 0, 0, 0});
      out_.ranges.push_back({static_cast<std::uint32_t>(set.shapes.size()), 0, true});
      for (const scene::Shape& shape : set.shapes) {
        const glm::vec3 half = set.kind == scene::ShapeKind::kSphere
                                   ? glm::vec3(shape.half_extent.x)
                                   : shape.half_extent;
        out_.shapes.push_back({shape.centre, half, shape.material});
      }
      out_.blas.push_back(blas);
      known = shared_shapes_
                  .emplace(instance.shape_set, static_cast<std::uint32_t>(out_.blas.size() - 1))
                  .first;
    }
    out_.instances.push_back({known->second, glm::mat4(instance.transform), false});
  }

  void add_emitters(const scene::Mesh& mesh, const glm::dmat4& transform) {
    for (const scene::Primitive& p : mesh.primitives) {
      const scene::Material& m = scene_.materials[p.material];
      if (m.emission == glm::vec3(0) || m.emissive_texture != kNoIndex) {
        continue;  // a texture's light is found by the paths themselves
      }
      for (std::size_t i = 0; i < p.indices.size(); i += 3) {
        glm::vec3 v[3];
        for (std::size_t c = 0; c < 3; ++c) {
          v[c] = glm::vec3(transform * glm::dvec4(glm::dvec3(p.positions[p.indices[i + c]]), 1));
        }
        // A mirrored instance turns the winding in world space, not the front.
        const bool flip = glm::determinant(glm::dmat3(transform)) < 0;
        out_.emitters.push_back({v[0], (flip ? v[2] : v[1]) - v[0], (flip ? v[1] : v[2]) - v[0],
                                 m.emission, 0, 0, m.double_sided ? 0U : 1U});
      }
    }
  }

  void finish_emitters() {
    std::vector<double> power;
    double total = 0;
    std::erase_if(out_.emitters, [](const gpu::Emitter& e) {
      const float area = glm::length(glm::cross(e.edge1, e.edge2));
      return !(area > 0) || !std::isfinite(area);
    });
    for (const gpu::Emitter& e : out_.emitters) {
      const double mean = (double{e.emission.x} + e.emission.y + e.emission.z) / 3;
      power.push_back(mean * glm::length(glm::cross(e.edge1, e.edge2)));
      total += power.back();
    }
    double sum = 0;
    for (std::size_t i = 0; i < power.size(); ++i) {
      sum += power[i];
      out_.emitters[i].cumulative = static_cast<float>(sum / total);
      out_.emitters[i].probability = static_cast<float>(power[i] / total);
    }
    if (!out_.emitters.empty()) {
      out_.emitters.back().cumulative = 1;
    }
  }

  void pack_lights() {
    for (const scene::Light& l : scene_.lights) {
      gpu::Light g{};
      g.color = l.color;
      g.kind = static_cast<std::uint32_t>(l.kind);
      g.position = l.position;
      g.radius = l.radius;
      g.direction = l.direction;
      g.range = l.range;
      g.cos_inner = std::cos(l.inner_angle);
      g.cos_outer = std::cos(l.outer_angle);
      out_.lights.push_back(g);
    }
  }

  const Scene& scene_;
  const effects::Choice& choice_;
  bool opaque_by_material_;
  PackedScene out_;
  std::map<std::pair<std::uint32_t, bool>, std::uint32_t> shared_;  // by mesh and side
  std::map<std::uint32_t, std::uint32_t> shared_shapes_;
};

}  // namespace

PackedScene pack(const Scene& scene, const effects::Choice& choice, bool opaque_by_material) {
  return Packer(scene, choice, opaque_by_material).run();
}

}  // namespace a2rt::render
