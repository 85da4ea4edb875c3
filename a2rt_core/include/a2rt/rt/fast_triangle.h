// The driver's triangle test (workload/driver_triangle.h), bit for bit, arranged for speed: the
// axes are chosen by constant offsets, the three vertices share vector instructions, and the
// verdict comes before the divisions.
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>

#include "a2rt/base/vec.h"
#include "a2rt/workload/workload.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

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

  // True if the line meets the triangle ahead; then t (may be NaN) and the facing are set.
  bool operator()(const AxisTriangle& triangle, float& t, bool& front) const {
    Edges e;
    float z[4];
    if (!edges(triangle, e, z)) {
      return false;
    }
    const double det = e.u + (e.v + e.w);
    const double sz = sz_;
    const double distance = (e.u * (sz * z[0]) + e.v * (sz * z[1])) + e.w * (sz * z[2]);
    const double sign = det > 0 ? 1 : det < 0 ? -1 : 0;
    if (sign * distance < 0) {
      return false;
    }
    t = static_cast<float>(distance / det);
    front = static_cast<float>(det) > 0;
    return true;
  }

 private:
  struct Edges {
    double u, v, w;
  };

#if defined(__SSE2__)
  // Edge functions and the vertices' z; false if their signs differ.
  bool edges(const AxisTriangle& triangle, Edges& e, float* z) const {
    // Lane 3 is not part of the triangle and never read.
    const __m128 dz = _mm_sub_ps(_mm_loadu_ps(triangle.axis[kz_]), _mm_set1_ps(oz_));
    const __m128 x = _mm_sub_ps(_mm_sub_ps(_mm_loadu_ps(triangle.axis[kx_]), _mm_set1_ps(ox_)),
                                _mm_mul_ps(_mm_set1_ps(sx_), dz));
    const __m128 y = _mm_sub_ps(_mm_sub_ps(_mm_loadu_ps(triangle.axis[ky_]), _mm_set1_ps(oy_)),
                                _mm_mul_ps(_mm_set1_ps(sy_), dz));
    const __m128d x_bc = _mm_cvtps_pd(_mm_shuffle_ps(x, x, _MM_SHUFFLE(3, 3, 2, 1)));
    const __m128d y_bc = _mm_cvtps_pd(_mm_shuffle_ps(y, y, _MM_SHUFFLE(3, 3, 2, 1)));
    const __m128d x_ca = _mm_cvtps_pd(_mm_shuffle_ps(x, x, _MM_SHUFFLE(3, 3, 0, 2)));
    const __m128d y_ca = _mm_cvtps_pd(_mm_shuffle_ps(y, y, _MM_SHUFFLE(3, 3, 0, 2)));
    const __m128d uv = _mm_sub_pd(_mm_mul_pd(x_ca, y_bc), _mm_mul_pd(y_ca, x_bc));
    const __m128d x_aa = _mm_unpackhi_pd(x_ca, x_ca), y_aa = _mm_unpackhi_pd(y_ca, y_ca);
    const __m128d x_bb = _mm_unpacklo_pd(x_bc, x_bc), y_bb = _mm_unpacklo_pd(y_bc, y_bc);
    const __m128d ww = _mm_sub_pd(_mm_mul_pd(x_bb, y_aa), _mm_mul_pd(y_bb, x_aa));
    const __m128d zero = _mm_setzero_pd();
    const int below = _mm_movemask_pd(_mm_or_pd(_mm_cmplt_pd(uv, zero), _mm_cmplt_pd(ww, zero)));
    const int above = _mm_movemask_pd(_mm_or_pd(_mm_cmpgt_pd(uv, zero), _mm_cmpgt_pd(ww, zero)));
    if (below != 0 && above != 0) {
      return false;
    }
    e = {_mm_cvtsd_f64(uv), _mm_cvtsd_f64(_mm_unpackhi_pd(uv, uv)), _mm_cvtsd_f64(ww)};
    _mm_storeu_ps(z, dz);
    return true;
  }
#else
  bool edges(const AxisTriangle& triangle, Edges& e, float* z) const {
    double x[3], y[3];
    for (std::size_t v = 0; v < 3; ++v) {
      z[v] = triangle.axis[kz_][v] - oz_;
      x[v] = (triangle.axis[kx_][v] - ox_) - sx_ * z[v];
      y[v] = (triangle.axis[ky_][v] - oy_) - sy_ * z[v];
    }
    e = {x[2] * y[1] - y[2] * x[1], x[0] * y[2] - y[0] * x[2], x[1] * y[0] - y[1] * x[0]};
    return !((e.u < 0 || e.v < 0 || e.w < 0) && (e.u > 0 || e.v > 0 || e.w > 0));
  }
#endif

  std::size_t kx_, ky_, kz_;
  float sx_, sy_, sz_;
  float ox_, oy_, oz_;
};

}  // namespace a2rt::rt
