#include "scene/mesh_builder.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace a2rt::scene {
namespace {

constexpr float kPi = 3.14159265358979F;

// Keeps the optional arrays as long as the positions.
void add_vertex(Primitive& p, const glm::vec3& position, const glm::vec3& normal,
                const glm::vec2& uv) {
  p.positions.push_back(position);
  p.normals.push_back(normal);
  p.uvs.push_back(uv);
}

std::uint32_t next_vertex(const Primitive& p) {
  return static_cast<std::uint32_t>(p.positions.size());
}

}  // namespace

void add_quad(Primitive& p, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v) {
  const std::uint32_t first = next_vertex(p);
  const glm::vec3 normal = glm::normalize(glm::cross(u, v));
  add_vertex(p, corner, normal, {0, 0});
  add_vertex(p, corner + u, normal, {1, 0});
  add_vertex(p, corner + u + v, normal, {1, 1});
  add_vertex(p, corner + v, normal, {0, 1});
  for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) {
    p.indices.push_back(first + i);
  }
}

void add_box(Primitive& p, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v,
             const glm::vec3& w) {
  add_quad(p, corner, v, u);
  add_quad(p, corner, w, v);
  add_quad(p, corner, u, w);
  add_quad(p, corner + w, u, v);
  add_quad(p, corner + u, v, w);
  add_quad(p, corner + v, w, u);
}

void add_sphere(Primitive& p, const glm::vec3& centre, float radius, std::uint32_t rings,
                std::uint32_t segments) {
  const std::uint32_t first = next_vertex(p);
  for (std::uint32_t r = 0; r <= rings; ++r) {
    for (std::uint32_t s = 0; s <= segments; ++s) {
      const float v = static_cast<float>(r) / static_cast<float>(rings);
      const float u = static_cast<float>(s) / static_cast<float>(segments);
      const float theta = kPi * v;
      const float phi = 2 * kPi * u;
      const glm::vec3 n{std::sin(theta) * std::cos(phi), std::cos(theta),
                        -std::sin(theta) * std::sin(phi)};
      add_vertex(p, centre + radius * n, n, {u, v});
    }
  }
  const std::uint32_t row = segments + 1;
  for (std::uint32_t r = 0; r < rings; ++r) {
    for (std::uint32_t s = 0; s < segments; ++s) {
      const std::uint32_t a = first + r * row + s;
      if (r > 0) {
        p.indices.insert(p.indices.end(), {a, a + row, a + 1});
      }
      if (r + 1 < rings) {
        p.indices.insert(p.indices.end(), {a + 1, a + row, a + row + 1});
      }
    }
  }
}

void add_tube(Primitive& p, const glm::vec3& from, const glm::vec3& to, float radius_from,
              float radius_to, std::uint32_t segments) {
  const std::uint32_t first = next_vertex(p);
  const glm::vec3 axis = glm::normalize(to - from);
  const glm::vec3 helper = std::abs(axis.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 t = glm::normalize(glm::cross(helper, axis));
  const glm::vec3 b = glm::cross(axis, t);
  const float length = glm::length(to - from);
  for (std::uint32_t s = 0; s <= segments; ++s) {
    const float u = static_cast<float>(s) / static_cast<float>(segments);
    const glm::vec3 n = t * std::cos(2 * kPi * u) + b * std::sin(2 * kPi * u);
    add_vertex(p, from + radius_from * n, n, {u, 0});
    add_vertex(p, to + radius_to * n, n, {u, length / (2 * kPi * std::max(radius_from, 1e-6F))});
  }
  for (std::uint32_t s = 0; s < segments; ++s) {
    const std::uint32_t a = first + 2 * s;
    p.indices.insert(p.indices.end(), {a, a + 2, a + 1, a + 1, a + 2, a + 3});
  }
}

std::uint32_t place(Scene& scene, const std::string& name, std::vector<Primitive> primitives) {
  const auto index = static_cast<std::uint32_t>(scene.meshes.size());
  scene.meshes.push_back({name, std::move(primitives)});
  Instance instance;
  instance.name = name;
  instance.mesh = index;
  scene.instances.push_back(std::move(instance));
  return index;
}

std::uint32_t add_material(Scene& scene, Material material) {
  scene.materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

Material diffuse(const std::string& name, const glm::vec3& color) {
  Material m;
  m.name = name;
  m.base_color = color;
  m.double_sided = true;
  return m;
}

Material metal(const std::string& name, const glm::vec3& color, float fuzz) {
  Material m = diffuse(name, color);
  m.kind = MaterialKind::kMetal;
  m.metallic = 1;
  m.roughness = fuzz;
  return m;
}

Material glass(const std::string& name, float ior) {
  Material m = diffuse(name, glm::vec3(1));
  m.kind = MaterialKind::kGlass;
  m.roughness = 0;
  m.transmission = 1;
  m.ior = ior;
  return m;
}

Material emissive(const std::string& name, const glm::vec3& radiance) {
  Material m = diffuse(name, glm::vec3(0));
  m.kind = MaterialKind::kEmissive;
  m.emission = radiance;
  return m;
}

Camera look_at(const std::string& name, const glm::vec3& eye, const glm::vec3& centre,
               float fov_degrees) {
  Camera c;
  c.name = name;
  c.eye = eye;
  c.forward = glm::normalize(centre - eye);
  if (std::abs(c.forward.y) > 0.9999F) {
    c.up = {0, 0, 1};
  }
  c.vertical_fov = glm::radians(fov_degrees);
  c.focus_distance = glm::length(centre - eye);
  return c;
}

Camera frame_automatically(const Bounds& bounds) {
  constexpr float kFov = 40;
  const float radius = std::max(0.5F * bounds.diagonal(), 1e-30F);
  const float distance = radius / std::sin(glm::radians(kFov) / 2);
  const glm::vec3 from = glm::normalize(glm::vec3(0.45F, 0.35F, 1.0F));
  Camera c = look_at("automatic", bounds.centre() + distance * from, bounds.centre(), kFov);
  return c;
}

float Random::next() {
  // PCG-XSH-RR 64/32 (O'Neill 2014).
  const std::uint64_t old = state_;
  state_ = old * 6364136223846793005ULL + 1442695040888963407ULL;
  const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
  const auto rotate = static_cast<std::uint32_t>(old >> 59U);
  const std::uint32_t word = (shifted >> rotate) | (shifted << ((32U - rotate) & 31U));
  return static_cast<float>(word >> 8U) * (1.0F / 16777216.0F);
}

}  // namespace a2rt::scene
