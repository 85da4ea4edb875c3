// The field of spheres from the cover of "Ray Tracing in One Weekend" (P. Shirley): one procedural
// sphere each, no triangles. Camera and lens as LumiBench's WKND.
#include <glm/geometric.hpp>

#include "embedded/embedded.h"
#include "scene/mesh_builder.h"

namespace a2rt::embedded {
namespace {

glm::vec3 random_color(scene::Random& random, float lo, float hi) {
  const float r = random.between(lo, hi);
  const float g = random.between(lo, hi);
  return {r, g, random.between(lo, hi)};
}

scene::Scene make_spheres() {
  scene::Scene s;
  scene::Random random(42);
  scene::ShapeSet field;
  field.name = "field";
  const auto add = [&](const glm::vec3& centre, float radius, std::uint32_t material) {
    field.shapes.push_back({centre, glm::vec3(radius), material});
  };
  const auto clear = add_material(s, scene::glass("glass", 1.5F));
  add({0, -1000, 0}, 1000, add_material(s, scene::diffuse("ground", {0.5F, 0.5F, 0.5F})));
  for (int a = -11; a < 11; ++a) {
    for (int b = -11; b < 11; ++b) {
      const float choice = random.next();
      const float x = static_cast<float>(a) + 0.9F * random.next();
      const float z = static_cast<float>(b) + 0.9F * random.next();
      // On the ground's curve, not at a fixed height: far ones would float otherwise.
      const float radius = 0.2F;
      const glm::vec3 up = glm::normalize(glm::vec3(x, 1000.0F, z));
      const glm::vec3 centre = glm::vec3(0, -1000, 0) + (1000.0F + radius) * up;
      const std::string name = std::to_string(a) + "," + std::to_string(b);
      std::uint32_t material = clear;
      if (choice < 0.8F) {
        const glm::vec3 color = random_color(random, 0, 1) * random_color(random, 0, 1);
        material = add_material(s, scene::diffuse("matt " + name, color));
      } else if (choice < 0.95F) {
        const glm::vec3 color = random_color(random, 0.5F, 1);
        material = add_material(s, scene::metal("metal " + name, color, 0.5F * random.next()));
      }
      if (glm::length(centre - glm::vec3(4, 0.2F, 0)) > 0.9F) {
        add(centre, radius, material);
      }
    }
  }
  add({0, 1, 0}, 1, clear);
  add({-4, 1, 0}, 1, add_material(s, scene::diffuse("clay", {0.4F, 0.2F, 0.1F})));
  add({4, 1, 0}, 1, add_material(s, scene::metal("polished", {0.7F, 0.6F, 0.5F}, 0)));
  s.shape_sets.push_back(std::move(field));
  scene::Instance instance;
  instance.name = "field";
  instance.shape_set = 0;
  s.instances.push_back(instance);
  s.sky.present = true;
  scene::Camera camera = scene::look_at("cover", {13, 2, 3}, {0, 0, 0}, 20);
  camera.aperture = 0.1F;
  camera.focus_distance = 10;
  s.cameras.push_back(camera);
  return s;
}

const RegisterScene kSpheres{"spheres", "a field of procedural spheres: matt, metal, glass",
                             make_spheres};

}  // namespace
}  // namespace a2rt::embedded
