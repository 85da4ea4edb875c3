// The driver's triangle test (workload/driver_triangle.h), bit for bit, arranged for speed: the
// axes are chosen by constant offsets, the three vertices share vector instructions, the verdict
// comes before the divisions, and a leaf's triangles are tested in one go.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "a2rt/base/vec.h"
#include "a2rt/workload/workload.h"

namespace a2rt::rt {

// A triangle axis by axis, so that a test picks its axes by an offset. The vector code reads four
// bytes past the end: keep one more element after the last.
struct AxisTriangle {
  float axis[3][3] = {};  // [axis][vertex]

  AxisTriangle() = default;
  explicit AxisTriangle(const Triangle& triangle) {
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t v = 0; v < 3; ++v) {
        axis[a][v] = triangle.v[v][a];
      }
    }
  }
};
static_assert(sizeof(AxisTriangle) == sizeof(Triangle));

class FastTriangle {
 public:
  FastTriangle(const Vec3& origin, const Vec3& dir) {
    const float o[3] = {origin.x, origin.y, origin.z}, d[3] = {dir.x, dir.y, dir.z};
    const float ax = std::fabs(d[0]), ay = std::fabs(d[1]), az = std::fabs(d[2]);
    kz_ = ax >= ay ? (ax >= az ? 0 : 2) : (ay >= az ? 1 : 2);
    kx_ = (kz_ + 1) % 3;
    ky_ = (kx_ + 1) % 3;
    if (d[kz_] < 0) {
      std::swap(kx_, ky_);
    }
    sz_ = 1.0F / d[kz_];
    sx_ = d[kx_] * sz_;
    sy_ = d[ky_] * sz_;
    ox_ = o[kx_], oy_ = o[ky_], oz_ = o[kz_];
  }

  // Edge functions of a triangle, and its vertices' z.
  struct Edges {
    double u, v, w;
    float z[4];  // the fourth is room for vector code
  };

  // The first of `count` triangles that the line meets, and its edges; `count` if there is none.
  // Reads four bytes past the last one.
  std::uint32_t find(const AxisTriangle* triangles, std::uint32_t count, Edges& e) const;
  // The same, without vectors of the processor at hand.
  std::uint32_t find_scalar(const AxisTriangle* triangles, std::uint32_t count, Edges& e) const;

  // True if a triangle that the line meets lies ahead; then t (may be NaN) and the facing are set.
  bool ahead(const Edges& e, float& t, bool& front) const {
    const double det = e.u + (e.v + e.w);
    const double sz = sz_;
    const double distance = (e.u * (sz * e.z[0]) + e.v * (sz * e.z[1])) + e.w * (sz * e.z[2]);
    const double sign = det > 0 ? 1 : det < 0 ? -1 : 0;
    if (sign * distance < 0) {
      return false;
    }
    t = static_cast<float>(distance / det);
    front = static_cast<float>(det) > 0;
    return true;
  }

 private:
  std::uint32_t find_avx2(const AxisTriangle* triangles, std::uint32_t count, Edges& e) const;

  std::size_t kx_, ky_, kz_;
  float sx_, sy_, sz_;
  float ox_, oy_, oz_;
};

}  // namespace a2rt::rt
