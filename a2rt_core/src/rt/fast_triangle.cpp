#include "a2rt/rt/fast_triangle.h"

#include "a2rt/base/vector_support.h"

namespace a2rt::rt {

// The edges' signs agree; is the plane met ahead of the origin?
bool FastTriangle::meets_ahead(const Edges& e, const float* z, float& t, bool& front) const {
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

std::uint32_t FastTriangle::first_met_scalar(const AxisTriangle* triangles, std::uint32_t count,
                                             float& t, bool& front) const {
  for (std::uint32_t i = 0; i < count; ++i) {
    float z[3];
    double x[3], y[3];
    for (std::size_t v = 0; v < 3; ++v) {
      z[v] = triangles[i].axis[kz_][v] - oz_;
      x[v] = (triangles[i].axis[kx_][v] - ox_) - sx_ * z[v];
      y[v] = (triangles[i].axis[ky_][v] - oy_) - sy_ * z[v];
    }
    const Edges e = {x[2] * y[1] - y[2] * x[1], x[0] * y[2] - y[0] * x[2],
                     x[1] * y[0] - y[1] * x[0]};
    const bool below = e.u < 0 || e.v < 0 || e.w < 0, above = e.u > 0 || e.v > 0 || e.w > 0;
    if (!(below && above) && meets_ahead(e, z, t, front)) {
      return i;
    }
  }
  return count;
}

#if A2RT_HAS_X86_VECTORS

// Lane 3 is not part of a triangle, and what becomes of it is never looked at.
A2RT_AVX2 std::uint32_t FastTriangle::first_met_avx2(const AxisTriangle* triangles,
                                                     std::uint32_t count, float& t,
                                                     bool& front) const {
  constexpr int kVertices = 7;
  constexpr int kNext = 0b11001001;  // vertices b, c, a
  const __m128 ox = _mm_set1_ps(ox_), oy = _mm_set1_ps(oy_), oz = _mm_set1_ps(oz_);
  const __m128 sx = _mm_set1_ps(sx_), sy = _mm_set1_ps(sy_);
  const __m256d zero = _mm256_setzero_pd();
  for (std::uint32_t i = 0; i < count; ++i) {
    const AxisTriangle& triangle = triangles[i];
    const __m128 dz = _mm_sub_ps(_mm_loadu_ps(triangle.axis[kz_]), oz);
    const __m256d x = _mm256_cvtps_pd(
        _mm_sub_ps(_mm_sub_ps(_mm_loadu_ps(triangle.axis[kx_]), ox), _mm_mul_ps(sx, dz)));
    const __m256d y = _mm256_cvtps_pd(
        _mm_sub_ps(_mm_sub_ps(_mm_loadu_ps(triangle.axis[ky_]), oy), _mm_mul_ps(sy, dz)));
    const __m256d wuv = _mm256_sub_pd(_mm256_mul_pd(_mm256_permute4x64_pd(x, kNext), y),
                                      _mm256_mul_pd(_mm256_permute4x64_pd(y, kNext), x));
    const int below = _mm256_movemask_pd(_mm256_cmp_pd(wuv, zero, _CMP_LT_OQ)) & kVertices;
    const int above = _mm256_movemask_pd(_mm256_cmp_pd(wuv, zero, _CMP_GT_OQ)) & kVertices;
    if (below == 0 || above == 0) [[unlikely]] {
      double e[4];
      float z[4];
      _mm256_storeu_pd(e, wuv);
      _mm_storeu_ps(z, dz);
      if (meets_ahead({e[1], e[2], e[0]}, z, t, front)) {
        return i;
      }
    }
  }
  return count;
}

std::uint32_t FastTriangle::first_met(const AxisTriangle* triangles, std::uint32_t count, float& t,
                                      bool& front) const {
  return has_avx2() ? first_met_avx2(triangles, count, t, front)
                    : first_met_scalar(triangles, count, t, front);
}

#else

std::uint32_t FastTriangle::first_met(const AxisTriangle* triangles, std::uint32_t count, float& t,
                                      bool& front) const {
  return first_met_scalar(triangles, count, t, front);
}

#endif

}  // namespace a2rt::rt
