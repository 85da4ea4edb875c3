#include <cstdint>

#include "a2rt/arith/aqb8_arith.h"
#include "a2rt/base/vector_support.h"

namespace a2rt::arith {

std::uint32_t aqb8_test_block_scalar(const Aqb8Ray& ray, const Aqb8Local& local,
                                     const Aqb8Block& boxes,
                                     std::int32_t entry[Aqb8Block::kWidth]) {
  std::uint32_t mask = 0;
  for (std::size_t slot = 0; slot < Aqb8Block::kWidth; ++slot) {
    const Aqb8Hit hit = aqb8_test(ray, local, boxes.get(slot));
    mask |= (hit.hit ? 1U : 0U) << slot;
    entry[slot] = hit.entry;
  }
  return mask;
}

#if A2RT_HAS_X86_VECTORS

namespace {

// Slope times plane, plus the local origin, in wrapping 32-bit integers. A significand has 8 bits
// and a plane 8, so the multiply-add of 16-bit halves is exact; its sign goes with it.
A2RT_AVX2 inline __attribute__((always_inline)) __m256i distances(const std::uint8_t* planes,
                                                                  std::uint32_t copy,
                                                                  unsigned negative,
                                                                  std::int32_t origin) {
  const std::uint32_t significand = 128U + (copy & 127U);
  const std::uint32_t factor = ((significand ^ (0U - negative)) + negative) & 0xFFFFU;
  const __m256i plane =
      _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(planes)));
  const __m128i shift = _mm_cvtsi32_si128(static_cast<int>(copy >> 7 & 31U));
  return _mm256_add_epi32(
      _mm256_sll_epi32(_mm256_madd_epi16(plane, _mm256_set1_epi32(static_cast<int>(factor))),
                       shift),
      _mm256_set1_epi32(origin));
}

A2RT_AVX2 std::uint32_t test_block_avx2(const Aqb8Ray& ray, const Aqb8Local& local,
                                        const Aqb8Block& boxes, std::int32_t* entry) {
  __m256i in = _mm256_setzero_si256();
  __m256i out = _mm256_set1_epi32(local.qy_max);
  for (unsigned a = 0; a < 3; ++a) {
    // Signs are as good as random: no branches.
    const unsigned negative = ray.negative >> a & 1U;
    const std::uint8_t* near = boxes.planes[negative][a];
    const std::uint8_t* far = boxes.planes[1 - negative][a];
    in = _mm256_max_epi32(in, distances(near, ray.low[a], negative, local.low[a]));
    out = _mm256_min_epi32(out, distances(far, ray.high[a], negative, local.high[a]));
  }
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(entry), in);
  const __m256i late = _mm256_cmpgt_epi32(in, out);
  return ~static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(late))) & 0xFFU;
}

}  // namespace

std::uint32_t aqb8_test_block(const Aqb8Ray& ray, const Aqb8Local& local, const Aqb8Block& boxes,
                              std::int32_t entry[Aqb8Block::kWidth]) {
  return has_avx2() ? test_block_avx2(ray, local, boxes, entry)
                    : aqb8_test_block_scalar(ray, local, boxes, entry);
}

#else

std::uint32_t aqb8_test_block(const Aqb8Ray& ray, const Aqb8Local& local, const Aqb8Block& boxes,
                              std::int32_t entry[Aqb8Block::kWidth]) {
  return aqb8_test_block_scalar(ray, local, boxes, entry);
}

#endif

}  // namespace a2rt::arith
