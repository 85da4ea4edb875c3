// Geometry that is hard on a box test: flat sheets, needles and fans, coincident faces, shapes far
// from the origin, extents from 1e-3 to 1e5 in one picture, squeezed and mirrored instances. Faces
// that coincide share material and winding, so that a tie never shows.
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "embedded/embedded.h"
#include "scene/mesh_builder.h"

namespace a2rt::embedded {
namespace {

using glm::vec3;
using scene::Primitive;

constexpr float kTau = 6.2831853F;

Primitive of(std::uint32_t material) {
  Primitive p;
  p.material = material;
  return p;
}

// A disc of needle triangles that all meet in one point.
Primitive fan(std::uint32_t material, const vec3& centre, const vec3& u, const vec3& v,
              std::uint32_t blades) {
  Primitive p = of(material);
  p.positions.push_back(centre);
  for (std::uint32_t i = 0; i <= blades; ++i) {
    const float a = kTau * static_cast<float>(i % blades) / static_cast<float>(blades);
    p.positions.push_back(centre + std::cos(a) * u + std::sin(a) * v);
    if (i > 0) {
      p.indices.insert(p.indices.end(), {0, i, i + 1});
    }
  }
  return p;
}

// Straws: tubes a thousand times longer than thick, leaning in all directions.
Primitive straws(std::uint32_t material, const vec3& foot, scene::Random& random) {
  Primitive p = of(material);
  for (int i = 0; i < 60; ++i) {
    const float phi = kTau * random.next();
    const float lean = random.between(0, 0.55F);
    const vec3 tip = foot + vec3(lean * std::cos(phi), 1, lean * std::sin(phi)) * 2.6F;
    scene::add_tube(p, foot + 0.2F * vec3(std::cos(phi), 0, std::sin(phi)), tip, 0.006F, 0.0015F,
                    5);
  }
  return p;
}

// Exactly flat, axis-aligned sheets, every one of them there twice.
Primitive doubled_sheets(std::uint32_t material, const vec3& corner) {
  Primitive p = of(material);
  for (int i = 0; i < 7; ++i) {
    const vec3 at = corner + vec3(0, 0.28F * static_cast<float>(i), 0);
    const float size = 1.5F - 0.17F * static_cast<float>(i);
    const vec3 inset(0.085F * static_cast<float>(i), 0, 0.085F * static_cast<float>(i));
    for (int copy = 0; copy < 2; ++copy) {
      scene::add_quad(p, at + inset, {0, 0, size}, {size, 0, 0});
    }
  }
  p.normals.clear();
  return p;
}

// Blocks that touch: inner faces coincide and look at each other.
Primitive touching_blocks(std::uint32_t material, const vec3& corner) {
  Primitive p = of(material);
  constexpr float kEdge = 0.5F;
  for (int x = 0; x < 3; ++x) {
    for (int y = 0; y < 3 - x; ++y) {
      for (int z = 0; z < 3 - x - y; ++z) {
        const vec3 at = corner + kEdge * vec3(static_cast<float>(x), static_cast<float>(y),
                                              static_cast<float>(z));
        scene::add_box(p, at, {kEdge, 0, 0}, {0, kEdge, 0}, {0, 0, kEdge});
      }
    }
  }
  p.normals.clear();
  return p;
}

// A strip whose triangles are 4e4 times longer than wide, plus some without any area.
Primitive ribbons(std::uint32_t material, const vec3& corner) {
  Primitive p = of(material);
  for (int i = 0; i < 24; ++i) {
    const float y = 0.07F * static_cast<float>(i);
    scene::add_quad(p, corner + vec3(0, y, 0.02F * static_cast<float>(i)), {2.2F, 0, 0},
                    {0, 0.02F, 0});
  }
  p.normals.clear();
  const auto first = static_cast<std::uint32_t>(p.positions.size());
  for (int i = 0; i < 3; ++i) {
    p.positions.push_back(corner + vec3(static_cast<float>(i), 0.5F * static_cast<float>(i), 0));
  }
  p.uvs.clear();
  p.indices.insert(p.indices.end(), {first, first, first, first, first + 1, first + 1,  // no area
                                     first, first + 1, first + 2});
  return p;
}

// Mountains 3e4 away and 1e4 high behind a plain of one quad.
void add_far_parts(scene::Scene& s, std::uint32_t plain, std::uint32_t rock) {
  Primitive floor = of(plain);
  scene::add_quad(floor, {-1e5F, 0, 1e5F}, {2e5F, 0, 0}, {0, 0, -2e5F});
  floor.normals.clear();
  place(s, "plain", {floor});
  Primitive range = of(rock);
  scene::Random random(3);
  for (int i = 0; i < 18; ++i) {
    const float x = -4.5e4F + 5.2e3F * static_cast<float>(i) + random.between(-2e3F, 2e3F);
    const float z = -4.5e4F + random.between(-9e3F, 9e3F);
    const float height = random.between(2.5e3F, 8.5e3F);
    const float width = random.between(3e3F, 8e3F);
    const auto first = static_cast<std::uint32_t>(range.positions.size());
    range.positions.insert(
        range.positions.end(),
        {vec3(x, height, z), vec3(x - width, 0, z + width), vec3(x + width, 0, z + width),
         vec3(x + width, 0, z - width), vec3(x - width, 0, z - width)});
    for (std::uint32_t f = 1; f <= 4; ++f) {
      range.indices.insert(range.indices.end(), {first, first + f, first + f % 4 + 1});
    }
  }
  place(s, "mountains", {range});
}

void add_instances(scene::Scene& s, std::uint32_t material) {
  Primitive p = of(material);
  scene::add_sphere(p, {0, 0, 0}, 0.5F, 24, 48);
  s.meshes.push_back({"ball", {p}});
  const auto ball = static_cast<std::uint32_t>(s.meshes.size() - 1);
  const auto add = [&](const std::string& name, const glm::dmat4& m) {
    scene::Instance instance;
    instance.name = name;
    instance.mesh = ball;
    instance.transform = m;
    s.instances.push_back(instance);
  };
  const auto at = [](double x, double y, double z) {
    return glm::translate(glm::dmat4(1), glm::dvec3(x, y, z));
  };
  add("mirrored", glm::scale(at(-3.7, 0.5, 2.6), glm::dvec3(-1, 1, 1)));
  add("coin", glm::scale(glm::rotate(at(-2.5, 0.5, 2.9), 0.5, glm::dvec3(0, 1, 0)),
                         glm::dvec3(1, 1, 1e-4)));
  add("spindle", glm::scale(at(-1.4, 0.6, 2.9), glm::dvec3(0.05, 1.2, 0.05)));
  glm::dmat4 shear(1);
  shear[1][0] = 0.8;
  add("sheared", at(-0.3, 0.5, 2.9) * shear);
  add("dot", glm::scale(at(0.9, 0.05, 3.1), glm::dvec3(0.1)));
  add("speck", glm::scale(at(1.15, 0.005, 3.1), glm::dvec3(0.01)));
}

void add_shapes(scene::Scene& s, std::uint32_t glass, std::uint32_t chrome, std::uint32_t dust) {
  scene::ShapeSet balls;
  balls.name = "balls";
  balls.shapes = {{{2.1F, 0.45F, 2.7F}, vec3(0.45F), glass},
                  {{3.4F, 0.6F, 2.1F}, vec3(0.6F), chrome}};
  scene::ShapeSet boxes;
  boxes.name = "boxes";
  boxes.kind = scene::ShapeKind::kBox;
  scene::Random random(9);
  for (int i = 0; i < 260; ++i) {  // a cloud of grains, some of them flat
    const float phi = kTau * random.next();
    const float r = 0.75F * std::sqrt(random.next());
    const vec3 centre{3.3F + r * std::cos(phi), random.between(0.02F, 1.9F),
                      -0.6F + r * std::sin(phi)};
    vec3 half{random.between(1e-3F, 0.03F), random.between(1e-3F, 0.03F),
              random.between(1e-3F, 0.03F)};
    if (i % 5 == 0) {
      half[i % 3] = 0;
    }
    boxes.shapes.push_back({centre, half, dust});
  }
  for (scene::ShapeSet* set : {&balls, &boxes}) {
    scene::Instance instance;
    instance.name = set->name;
    instance.shape_set = static_cast<std::uint32_t>(s.shape_sets.size());
    s.instances.push_back(instance);
    s.shape_sets.push_back(*set);
  }
}

scene::Scene make_torture() {
  scene::Scene s;
  scene::Random random(17);
  const auto plain = add_material(s, scene::diffuse("plain", {0.42F, 0.40F, 0.36F}));
  const auto rock = add_material(s, scene::diffuse("rock", {0.30F, 0.33F, 0.42F}));
  const auto orange = add_material(s, scene::diffuse("orange", {0.85F, 0.36F, 0.08F}));
  const auto teal = add_material(s, scene::diffuse("teal", {0.06F, 0.45F, 0.46F}));
  const auto yellow = add_material(s, scene::diffuse("yellow", {0.83F, 0.66F, 0.12F}));
  const auto red = add_material(s, scene::diffuse("red", {0.66F, 0.08F, 0.10F}));
  const auto blue = add_material(s, scene::diffuse("blue", {0.10F, 0.22F, 0.62F}));
  const auto brushed = add_material(s, scene::metal("brushed", {0.9F, 0.86F, 0.8F}, 0.25F));
  const auto chrome = add_material(s, scene::metal("chrome", {0.9F, 0.9F, 0.92F}, 0));
  const auto glass = add_material(s, scene::glass("glass", 1.5F));
  add_far_parts(s, plain, rock);
  place(s, "fan", {fan(orange, {-3.6F, 1.25F, -0.4F}, {1.2F, 0, 0.35F}, {0, 1.2F, 0}, 720)});
  place(s, "straws", {straws(yellow, {-1.4F, 0, -0.2F}, random)});
  place(s, "sheets", {doubled_sheets(teal, {-0.4F, 0.02F, -1.1F})});
  place(s, "blocks", {touching_blocks(red, {1.35F, 0, 0.1F})});
  place(s, "ribbons", {ribbons(blue, {-1.3F, 0.1F, -3.2F})});
  add_instances(s, brushed);
  add_shapes(s, glass, chrome, orange);
  scene::Light sun;
  sun.name = "sun";
  sun.direction = glm::normalize(vec3(0.45F, 0.6F, 0.5F));
  sun.color = vec3(2.6F, 2.4F, 2.1F);
  s.lights.push_back(sun);
  s.sky.present = true;
  s.sky.bottom = {0.86F, 0.88F, 0.92F};
  s.sky.top = {0.30F, 0.48F, 0.85F};
  s.cameras.push_back(scene::look_at("gallery", {0.2F, 3.0F, 10.4F}, {0.05F, 0.95F, 0}, 40));
  return s;
}

const RegisterScene kTorture{"torture", "flat, sliver, coincident, far, huge and tiny geometry",
                             make_torture};

}  // namespace
}  // namespace a2rt::embedded
