// Makes the workload of a hard case: structures, instances, rays.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "a2rt/base/vec.h"
#include "a2rt/workload/synthetic.h"
#include "a2rt/workload/workload.h"

namespace a2rt::hard {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr std::uint32_t kRaysPerCase = 1500;

Vec3 operator+(const Vec3& a, const Vec3& b);
Vec3 operator-(const Vec3& a, const Vec3& b);
Vec3 operator*(float s, const Vec3& v);

class CaseBuilder {
 public:
  explicit CaseBuilder(std::uint64_t seed) : random_(seed) {}

  synthetic::Random& random() { return random_; }
  // Each gives the number of the new structure.
  std::uint32_t blas(std::vector<Triangle> triangles);
  std::uint32_t blas(std::vector<Box> boxes);
  void instance(std::uint32_t blas, const Affine& object_to_world = {});
  void ray(const Vec3& origin, const Vec3& direction, float tmin = 0, float tmax = kInfinity);
  // The workload, with one ray per launch id. One identity instance of each structure unless
  // instances were given.
  Workload finish();

  const std::vector<Triangle>& triangles(std::uint32_t blas = 0) const {
    return workload_.blas[blas].triangles;
  }
  // A point of a random triangle of structure `blas`: inside it, on an edge or a vertex, by turns.
  Vec3 surface_point(std::uint32_t blas = 0);

 private:
  Workload workload_;
  std::vector<Instance> instances_;
  synthetic::Random random_;
};

// Independent triangles, about `size` long, in [-1, 1]^3 times `scale`.
std::vector<Triangle> soup(std::uint32_t count, float size, float scale, std::uint64_t seed);
// The twelve triangles of an axis-aligned box.
void add_box(std::vector<Triangle>& triangles, const Box& box);
// A closed cube's surface, each face `steps` x `steps` cells.
std::vector<Triangle> subdivided_cube(const Box& box, std::uint32_t steps);
// `steps`^3 cubes that share their faces and fill [0, steps]^3.
std::vector<Triangle> stacked_cubes(std::uint32_t steps);
// A square of `steps` x `steps` cells at `level` of `axis`, from -1 to 1.
void add_flat_grid(std::vector<Triangle>& triangles, std::size_t axis, float level,
                   std::uint32_t steps);

}  // namespace a2rt::hard
