#include "scene/scene.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>

#include "a2rt/base/error.h"

namespace a2rt::scene {
namespace {

bool finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check(bool condition, const Scene& scene, const std::string& what) {
  if (!condition) {
    throw UserError("scene '" + scene.name + "': " + what);
  }
}

void validate_primitive(const Scene& scene, const Mesh& mesh, std::size_t number) {
  const Primitive& p = mesh.primitives[number];
  const std::string where = "mesh '" + mesh.name + "', primitive " + std::to_string(number) + ": ";
  check(p.indices.size() % 3 == 0, scene, where + "the number of indices is not a multiple of 3");
  check(p.normals.empty() || p.normals.size() == p.positions.size(), scene,
        where + "there are not as many normals as positions");
  check(p.uvs.empty() || p.uvs.size() == p.positions.size(), scene,
        where + "there are not as many texture coordinates as positions");
  check(p.material < scene.materials.size(), scene, where + "no such material");
  // The message is built for a bad index only: a scene has millions of good ones.
  const auto bad = std::find_if(p.indices.begin(), p.indices.end(),
                                [&p](std::uint32_t index) { return index >= p.positions.size(); });
  if (bad != p.indices.end()) {
    check(false, scene,
          where + "index " + std::to_string(*bad) + " is outside the " +
              std::to_string(p.positions.size()) + " vertices");
  }
}

void validate_material(const Scene& scene, const Material& m) {
  const std::string where = "material '" + m.name + "': ";
  for (const std::uint32_t t :
       {m.base_texture, m.metallic_roughness_texture, m.emissive_texture, m.normal_texture,
        m.transmission_texture, m.clearcoat_texture, m.clearcoat_roughness_texture}) {
    check(t == kNoIndex || t < scene.textures.size(), scene, where + "no such texture");
  }
  check(finite(m.base_color) && finite(m.emission) && finite(m.attenuation_color), scene,
        where + "a colour is not finite");
  for (const float value : {m.alpha, m.metallic, m.roughness, m.transmission, m.ior, m.clearcoat,
                            m.clearcoat_roughness, m.attenuation_distance, m.alpha_cutoff}) {
    check(std::isfinite(value) && value >= 0, scene, where + "a factor is negative or not finite");
  }
  check(m.ior > 0 || m.transmission == 0, scene, where + "index of refraction 0; use 1 or more");
}

void validate_camera(const Scene& scene, const Camera& c) {
  const std::string where = "camera '" + c.name + "': ";
  check(finite(c.eye) && finite(c.forward) && finite(c.up), scene, where + "not finite");
  if (c.orthographic_height == 0) {
    check(std::isfinite(c.vertical_fov) && c.vertical_fov > 0 && c.vertical_fov < 3.1415925F, scene,
          where + "it sees no area: the vertical field of view must lie between 0 and 180 degrees");
  } else {
    check(std::isfinite(c.orthographic_height) && c.orthographic_height > 0, scene,
          where + "it sees no area: the height of the view must be above 0");
  }
  check(glm::length(c.forward) > 0 && glm::length(glm::cross(c.forward, c.up)) > 1e-12F, scene,
        where + "its direction is zero or parallel to its up vector");
  check(std::isfinite(c.aperture) && c.aperture >= 0 && std::isfinite(c.focus_distance) &&
            c.focus_distance > 0,
        scene, where + "aperture must be 0 or more and the focus distance above 0");
}

bool has_area(const Mesh& mesh, const glm::dmat3& linear) {
  for (const Primitive& p : mesh.primitives) {
    for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
      const glm::dvec3 corner(p.positions[p.indices[i]]);
      const glm::dvec3 a = linear * (glm::dvec3(p.positions[p.indices[i + 1]]) - corner);
      const glm::dvec3 b = linear * (glm::dvec3(p.positions[p.indices[i + 2]]) - corner);
      if (glm::cross(a, b) != glm::dvec3(0)) {
        return true;
      }
    }
  }
  return false;
}

bool has_area(const ShapeSet& set, const glm::dmat3& linear) {
  return linear != glm::dmat3(0) &&
         std::any_of(set.shapes.begin(), set.shapes.end(),
                     [](const Shape& shape) { return shape.half_extent != glm::vec3(0); });
}

// Whether a ray could hit anything at all.
bool has_area(const Scene& scene) {
  return std::any_of(scene.instances.begin(), scene.instances.end(), [&](const Instance& placed) {
    const glm::dmat3 linear(placed.transform);
    return placed.mesh == kNoIndex ? has_area(scene.shape_sets[placed.shape_set], linear)
                                   : has_area(scene.meshes[placed.mesh], linear);
  });
}

}  // namespace

void Bounds::include(const glm::vec3& p) {
  lo = glm::min(lo, p);
  hi = glm::max(hi, p);
}

float Bounds::diagonal() const {
  const glm::dvec3 extent = glm::dvec3(hi) - glm::dvec3(lo);
  return static_cast<float>(std::min(glm::length(extent), 3.0e38));
}

Counts count(const Scene& scene) {
  Counts counts;
  std::vector<std::uint64_t> per_mesh;
  for (const Mesh& mesh : scene.meshes) {
    std::uint64_t triangles = 0;
    for (const Primitive& p : mesh.primitives) {
      triangles += p.indices.size() / 3;
      counts.vertices += p.positions.size();
    }
    per_mesh.push_back(triangles);
    counts.triangles += triangles;
    counts.primitives += mesh.primitives.size();
  }
  for (const ShapeSet& set : scene.shape_sets) {
    counts.shapes += set.shapes.size();
  }
  counts.meshes = scene.meshes.size();
  counts.instances = scene.instances.size();
  for (const Instance& instance : scene.instances) {
    counts.drawn_triangles += instance.mesh == kNoIndex ? 0 : per_mesh[instance.mesh];
  }
  return counts;
}

Bounds world_bounds(const Scene& scene) {
  Bounds bounds;
  for (const Instance& instance : scene.instances) {
    const auto include = [&](const glm::vec3& p) {
      bounds.include(glm::vec3(instance.transform * glm::dvec4(p, 1)));
    };
    if (instance.mesh != kNoIndex) {
      for (const Primitive& p : scene.meshes[instance.mesh].primitives) {
        for (const std::uint32_t index : p.indices) {
          include(p.positions[index]);
        }
      }
    } else {
      const ShapeSet& set = scene.shape_sets[instance.shape_set];
      for (const Shape& shape : set.shapes) {
        const glm::vec3 half =
            set.kind == ShapeKind::kSphere ? glm::vec3(shape.half_extent.x) : shape.half_extent;
        for (int corner = 0; corner < 8; ++corner) {
          include(shape.centre + half * glm::vec3((corner & 1) != 0 ? 1 : -1,
                                                  (corner & 2) != 0 ? 1 : -1,
                                                  (corner & 4) != 0 ? 1 : -1));
        }
      }
    }
  }
  return bounds;
}

void validate(const Scene& scene) {
  for (const Texture& t : scene.textures) {
    check(t.width > 0 && t.height > 0 && t.rgba.size() == std::size_t{4} * t.width * t.height,
          scene, "texture '" + t.name + "' has no pixels");
  }
  for (const Material& m : scene.materials) {
    validate_material(scene, m);
  }
  for (const Mesh& mesh : scene.meshes) {
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      validate_primitive(scene, mesh, p);
    }
  }
  for (const ShapeSet& set : scene.shape_sets) {
    for (const Shape& shape : set.shapes) {
      check(shape.material < scene.materials.size() && finite(shape.centre) &&
                finite(shape.half_extent),
            scene, "shape set '" + set.name + "' has a shape without material or not finite");
    }
  }
  for (const Instance& instance : scene.instances) {
    const bool one = (instance.mesh != kNoIndex) != (instance.shape_set != kNoIndex);
    check(one, scene, "instance '" + instance.name + "' places nothing or two things");
    check(instance.mesh == kNoIndex || instance.mesh < scene.meshes.size(), scene,
          "instance '" + instance.name + "': no such mesh");
    check(instance.shape_set == kNoIndex || instance.shape_set < scene.shape_sets.size(), scene,
          "instance '" + instance.name + "': no such shape set");
    for (int column = 0; column < 4; ++column) {
      check(finite(glm::vec3(instance.transform[column])), scene,
            "instance '" + instance.name + "': its transform is not finite in FP32");
    }
  }
  for (const Camera& camera : scene.cameras) {
    validate_camera(scene, camera);
  }
  const Bounds bounds = world_bounds(scene);
  check(bounds.valid(), scene, "nothing to draw: no triangle and no shape is placed in it");
  check(finite(bounds.lo) && finite(bounds.hi), scene, "its world bounds are not finite in FP32");
  check(has_area(scene), scene, "nothing to draw: none of its triangles and shapes has an area");
}

}  // namespace a2rt::scene
