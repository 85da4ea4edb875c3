// A Cornell box with a mirror block and a glass ball; x right, y up, the open side looks along +z.
#include <cmath>

#include "embedded/embedded.h"
#include "scene/mesh_builder.h"

namespace a2rt::embedded {
namespace {

using scene::Primitive;

constexpr float kSide = 5.5F;

Primitive of(std::uint32_t material) {
  Primitive p;
  p.material = material;
  return p;
}

// A block standing on the floor, turned by `degrees` about the vertical.
Primitive block(std::uint32_t material, const glm::vec3& base_centre, const glm::vec3& size,
                float degrees) {
  const float a = degrees * 3.14159265F / 180;
  const glm::vec3 u = size.x * glm::vec3(std::cos(a), 0, -std::sin(a));
  const glm::vec3 w = size.z * glm::vec3(std::sin(a), 0, std::cos(a));
  Primitive p = of(material);
  scene::add_box(p, base_centre - 0.5F * u - 0.5F * w, u, {0, size.y, 0}, w);
  return p;
}

scene::Scene make_cornell() {
  scene::Scene s;
  const auto white = add_material(s, scene::diffuse("white", {0.73F, 0.73F, 0.73F}));
  const auto red = add_material(s, scene::diffuse("red", {0.65F, 0.05F, 0.05F}));
  const auto green = add_material(s, scene::diffuse("green", {0.12F, 0.45F, 0.15F}));
  const auto mirror = add_material(s, scene::metal("mirror", {0.92F, 0.92F, 0.94F}, 0));
  const auto brushed = add_material(s, scene::metal("brushed gold", {0.9F, 0.68F, 0.32F}, 0.12F));
  const auto glass = add_material(s, scene::glass("glass", 1.5F));
  const auto lamp = add_material(s, scene::emissive("lamp", {7.2F, 6.0F, 4.4F}));

  Primitive shell = of(white);
  scene::add_quad(shell, {0, 0, kSide}, {kSide, 0, 0}, {0, 0, -kSide});  // floor
  scene::add_quad(shell, {0, kSide, 0}, {kSide, 0, 0}, {0, 0, kSide});   // ceiling
  scene::add_quad(shell, {0, 0, 0}, {kSide, 0, 0}, {0, kSide, 0});       // back
  Primitive left = of(red);
  scene::add_quad(left, {0, 0, kSide}, {0, 0, -kSide}, {0, kSide, 0});
  Primitive right = of(green);
  scene::add_quad(right, {kSide, 0, 0}, {0, 0, kSide}, {0, kSide, 0});
  place(s, "walls", {shell, left, right});

  Primitive panel = of(lamp);
  scene::add_quad(panel, {1.65F, kSide - 0.01F, 1.75F}, {2.2F, 0, 0}, {0, 0, 2.0F});
  place(s, "lamp", {panel});

  place(s, "mirror block", {block(mirror, {1.9F, 0, 1.8F}, {1.5F, 3.3F, 1.5F}, 36)});
  place(s, "pedestal", {block(white, {3.75F, 0, 3.3F}, {1.55F, 0.8F, 1.55F}, -17)});

  Primitive ball = of(glass);
  scene::add_sphere(ball, {3.75F, 1.62F, 3.3F}, 0.82F, 48, 96);
  place(s, "glass ball", {ball});
  Primitive bead = of(brushed);
  scene::add_sphere(bead, {1.55F, 0.45F, 4.15F}, 0.45F, 32, 64);
  place(s, "gold ball", {bead});

  s.cameras.push_back(scene::look_at("front", {kSide / 2, kSide / 2, 13.2F},
                                     {kSide / 2, kSide / 2 - 0.05F, 0}, 38));
  return s;
}

const RegisterScene kCornell{"cornell", "box with a mirror block, a glass ball and an area lamp",
                             make_cornell};

}  // namespace
}  // namespace a2rt::embedded
