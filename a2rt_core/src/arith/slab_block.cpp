#include <algorithm>
#include <limits>

#include "a2rt/arith/slab.h"
#include "a2rt/base/vector_support.h"
#include "slab_pad.h"

namespace a2rt::arith {

std::uint32_t slab_test_block_scalar(const SlabRay& ray, const BoxBlock& boxes, float tmax,
                                     float t_entry[BoxBlock::kWidth]) {
  std::uint32_t mask = 0;
  for (std::size_t slot = 0; slot < BoxBlock::kWidth; ++slot) {
    const SlabHit hit = slab_test(ray, boxes.get(slot), tmax);
    mask |= hit.hit ? 1U << slot : 0U;
    t_entry[slot] = hit.t_entry;
  }
  return mask;
}

#if A2RT_HAS_X86_VECTORS

namespace {

A2RT_AVX2 std::uint32_t slab_test_block_avx2(const SlabRay& ray, const BoxBlock& boxes, float tmax,
                                             float t_entry[BoxBlock::kWidth]) {
  const __m256 infinity = _mm256_set1_ps(std::numeric_limits<float>::infinity());
  __m256 near = _mm256_sub_ps(_mm256_setzero_ps(), infinity);
  __m256 far = infinity;
  for (unsigned a = 0; a < 3; ++a) {
    const bool negative = (ray.negative >> a & 1U) != 0;
    const __m256 first = _mm256_load_ps(negative ? boxes.hi[a] : boxes.lo[a]);
    const __m256 second = _mm256_load_ps(negative ? boxes.lo[a] : boxes.hi[a]);
    const __m256 origin = _mm256_set1_ps(ray.origin[a]);
    const __m256 rcp = _mm256_set1_ps(ray.rcp[a]);
    near = _mm256_max_ps(_mm256_mul_ps(_mm256_sub_ps(first, origin), rcp), near);
    far = _mm256_min_ps(_mm256_mul_ps(_mm256_sub_ps(second, origin), rcp), far);
  }
  near = _mm256_min_ps(near, _mm256_set1_ps(kLargestFloat));
  const __m256 absolute = _mm256_set1_ps(kAbsolutePad);
  near = _mm256_sub_ps(_mm256_mul_ps(near, _mm256_set1_ps(kNearPad)), absolute);
  far = _mm256_add_ps(_mm256_mul_ps(far, _mm256_set1_ps(kFarPad)), absolute);
  near = _mm256_max_ps(near, _mm256_set1_ps(ray.tmin));
  far = _mm256_min_ps(far, _mm256_set1_ps(tmax));
  _mm256_storeu_ps(t_entry, near);
  return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(near, far, _CMP_LE_OQ)));
}

}  // namespace

std::uint32_t slab_test_block(const SlabRay& ray, const BoxBlock& boxes, float tmax,
                              float t_entry[BoxBlock::kWidth]) {
  if (!ray.regular || !has_avx2()) [[unlikely]] {
    return slab_test_block_scalar(ray, boxes, tmax, t_entry);
  }
  return slab_test_block_avx2(ray, boxes, tmax, t_entry);
}

#else

std::uint32_t slab_test_block(const SlabRay& ray, const BoxBlock& boxes, float tmax,
                              float t_entry[BoxBlock::kWidth]) {
  return slab_test_block_scalar(ray, boxes, tmax, t_entry);
}

#endif

}  // namespace a2rt::arith
