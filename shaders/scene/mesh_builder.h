// Small shapes for the embedded scenes.
#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace a2rt::scene {

// Appends the parallelogram corner, corner+u, corner+u+v, corner+v; its front is u x v.
void add_quad(Primitive& p, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v);
// Appends the six faces of the box spanned by three edges from a corner (right-handed: out).
void add_box(Primitive& p, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v,
             const glm::vec3& w);
// Appends a latitude-longitude sphere with smooth normals.
void add_sphere(Primitive& p, const glm::vec3& centre, float radius, std::uint32_t rings,
                std::uint32_t segments);
// Appends a tapered tube with smooth normals and uv (around, along).
void add_tube(Primitive& p, const glm::vec3& from, const glm::vec3& to, float radius_from,
              float radius_to, std::uint32_t segments);

// Adds a mesh with an instance at the identity and returns its index.
std::uint32_t place(Scene& scene, const std::string& name, std::vector<Primitive> primitives);
// Adds a material and returns its index.
std::uint32_t add_material(Scene& scene, Material material);
Material diffuse(const std::string& name, const glm::vec3& color);
Material metal(const std::string& name, const glm::vec3& color, float fuzz);
Material glass(const std::string& name, float ior);
Material emissive(const std::string& name, const glm::vec3& radiance);

// A camera at `eye` looking at `centre`; vertical field of view in degrees.
Camera look_at(const std::string& name, const glm::vec3& eye, const glm::vec3& centre,
               float fov_degrees);
// A camera that sees all of `bounds` from a little above.
Camera frame_automatically(const Bounds& bounds);

// Uniform numbers in [0, 1), the same on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  float next();
  float between(float lo, float hi) { return lo + (hi - lo) * next(); }

 private:
  std::uint64_t state_;
};

}  // namespace a2rt::scene
