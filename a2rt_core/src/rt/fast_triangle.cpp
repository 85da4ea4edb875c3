#include "a2rt/rt/fast_triangle.h"

#include "a2rt/base/vector_support.h"

namespace a2rt::rt {

std::uint32_t FastTriangle::find_scalar(const AxisTriangle* triangles, std::uint32_t count,
                                        Edges& e) const {
  for (std::uint32_t i = 0; i < count; ++i) {
    double x[3], y[3];
    for (std::size_t v = 0; v < 3; ++v) {
      e.z[v] = triangles[i].axis[kz_][v] - oz_;
      x[v] = (triangles[i].axis[kx_][v] - ox_) - sx_ * e.z[v];
      y[v] = (triangles[i].axis[ky_][v] - oy_) - sy_ * e.z[v];
    }
    e.u = x[2] * y[1] - y[2] * x[1];
    e.v = x[0] * y[2] - y[0] * x[2];
    e.w = x[1] * y[0] - y[1] * x[0];
    const bool below = e.u < 0 || e.v < 0 || e.w < 0, above = e.u > 0 || e.v > 0 || e.w > 0;
    if (!(below && above)) {
      return i;
    }
  }
  return count;
}

#if A2RT_HAS_X86_VECTORS

// Lane 3 is not part of a triangle, and what becomes of it is never looked at.
A2RT_AVX2 std::uint32_t FastTriangle::find_avx2(const AxisTriangle* triangles, std::uint32_t count,
                                                Edges& e) const {
  constexpr int kVertices = 7;
  constexpr int kNext = 0b11001001;  // vertices b, c, a
  const __m128 ox = _mm_set1_ps(ox_), oy = _mm_set1_ps(oy_), oz = _mm_set1_ps(oz_);
  const __m128 sx = _mm_set1_ps(sx_), sy = _mm_set1_ps(sy_);
  const __m256d zero = _mm256_setzero_pd();
  const std::size_t at_x = kx_, at_y = ky_, at_z = kz_;
  for (std::uint32_t i = 0; i < count; ++i) {
    const AxisTriangle& triangle = triangles[i];
    const __m128 dz = _mm_sub_ps(_mm_loadu_ps(triangle.axis[at_z]), oz);
    const __m256d x = _mm256_cvtps_pd(
        _mm_sub_ps(_mm_sub_ps(_mm_loadu_ps(triangle.axis[at_x]), ox), _mm_mul_ps(sx, dz)));
    const __m256d y = _mm256_cvtps_pd(
        _mm_sub_ps(_mm_sub_ps(_mm_loadu_ps(triangle.axis[at_y]), oy), _mm_mul_ps(sy, dz)));
    const __m256d wuv = _mm256_sub_pd(_mm256_mul_pd(_mm256_permute4x64_pd(x, kNext), y),
                                      _mm256_mul_pd(_mm256_permute4x64_pd(y, kNext), x));
    const int below = _mm256_movemask_pd(_mm256_cmp_pd(wuv, zero, _CMP_LT_OQ)) & kVertices;
    const int above = _mm256_movemask_pd(_mm256_cmp_pd(wuv, zero, _CMP_GT_OQ)) & kVertices;
    if (below == 0 || above == 0) [[unlikely]] {
      const __m128d w_u = _mm256_castpd256_pd128(wuv);
      e.u = _mm_cvtsd_f64(_mm_unpackhi_pd(w_u, w_u));
      e.v = _mm_cvtsd_f64(_mm256_extractf128_pd(wuv, 1));
      e.w = _mm_cvtsd_f64(w_u);
      _mm_storeu_ps(e.z, dz);
      return i;
    }
  }
  return count;
}

std::uint32_t FastTriangle::find(const AxisTriangle* triangles, std::uint32_t count,
                                 Edges& e) const {
  return has_avx2() ? find_avx2(triangles, count, e) : find_scalar(triangles, count, e);
}

#else

std::uint32_t FastTriangle::find(const AxisTriangle* triangles, std::uint32_t count,
                                 Edges& e) const {
  return find_scalar(triangles, count, e);
}

#endif

}  // namespace a2rt::rt
