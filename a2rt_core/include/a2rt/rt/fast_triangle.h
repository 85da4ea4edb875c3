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

  // The first of `count` triangles that the line meets ahead, with its t (may be NaN) and facing;
  // `count` if there is none. Reads four bytes past the last one.
  std::uint32_t first_met(const AxisTriangle* triangles, std::uint32_t count, float& t,
                          bool& front) const;
  // The same, without vectors of the processor at hand.
  std::uint32_t first_met_scalar(const AxisTriangle* triangles, std::uint32_t count, float& t,
                                 bool& front) const;

 private:
  struct Edges {
    double u, v, w;
  };
  bool meets_ahead(const Edges& e, const float* z, float& t, bool& front) const;
  std::uint32_t first_met_avx2(const AxisTriangle* triangles, std::uint32_t count, float& t,
                               bool& front) const;

  std::size_t kx_, ky_, kz_;
  float sx_, sy_, sz_;
  float ox_, oy_, oz_;
};

}  // namespace a2rt::rt
