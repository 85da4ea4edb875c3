// AVX2 kernels of the quantized tester: eight boxes, all products exact in FP32.
//
// Why the results equal the reference's. |plane - origin| has at most 14 bits and a significand at
// most 10, so every product and every corrected product P * 2^e (P < 2^24) is an FP32 number: the
// multiplications and subtractions below do not round. Products cannot overflow: finite near rates
// are at most 2^112 (ray_quantizer.cpp). Rounding to the format is monotone, so it is applied once
// after max and min. A parallel axis has an infinite rate: 0 * inf = NaN is dropped by max/min
// (second operand), other products are the infinities the reference returns.
#include <limits>

#include "a2rt/base/vector_support.h"
#include "qbox_tables.h"

namespace a2rt::arith {

#if A2RT_HAS_X86_VECTORS

namespace {

enum class Columns { kExact, kShuffle, kGather };

struct AxisPlanes {
  __m256i near, far;
};

template <bool kWide>
A2RT_AVX2 inline __attribute__((always_inline)) __m256i load_planes(const std::byte* planes) {
  if constexpr (kWide) {
    return _mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(planes)));
  } else {
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(planes)));
  }
}

// Corrections of eight magnitudes from one table row.
template <Columns kColumns>
A2RT_AVX2 inline __attribute__((always_inline)) __m256 corrections(const std::int8_t* bytes,
                                                                   const std::int32_t* words,
                                                                   std::uint32_t row, int columns,
                                                                   __m256i low_bits) {
  if constexpr (kColumns == Columns::kShuffle) {
    const __m256i table = _mm256_broadcastsi128_si256(
        _mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes + 16 * std::size_t{row})));
    // Only the lowest byte of each lane is looked up; a set top bit makes the shuffle give zero.
    const __m256i index = _mm256_or_si256(low_bits, _mm256_set1_epi32(-2139062272));
    return _mm256_cvtepi32_ps(_mm256_shuffle_epi8(table, index));
  } else {
    const __m256i found =
        _mm256_i32gather_epi32(words + (std::size_t{row} << columns), low_bits, 4);
    return _mm256_cvtepi32_ps(found);
  }
}

template <bool kWide, Columns kColumns, bool kNearest>
A2RT_AVX2 std::uint32_t test_block(const QBoxTester::Tables& tables, const GroupRay& ray,
                                   const std::byte* block, float t_left, float* t_near) {
  constexpr std::size_t kRowBytes = QBoxTester::kWidth * (kWide ? 2 : 1);
  __m256 near = _mm256_setzero_ps();
  __m256 far = _mm256_set1_ps(t_left);
  const __m256i low_mask = _mm256_set1_epi32(static_cast<int>(tables.low_mask));
  for (unsigned a = 0; a < 3; ++a) {
    const bool negative = (ray.negative >> a & 1U) != 0;
    const __m256i near_planes = load_planes<kWide>(block + (negative ? 3 + a : a) * kRowBytes);
    const __m256i far_planes = load_planes<kWide>(block + (negative ? a : 3 + a) * kRowBytes);
    if constexpr (kColumns == Columns::kExact) {
      const __m256 ahead =
          _mm256_sub_ps(_mm256_cvtepi32_ps(near_planes), _mm256_set1_ps(ray.near_origin[a]));
      const __m256 behind =
          _mm256_sub_ps(_mm256_cvtepi32_ps(far_planes), _mm256_set1_ps(ray.far_origin[a]));
      near = _mm256_max_ps(_mm256_mul_ps(ahead, _mm256_set1_ps(ray.near_rate[a])), near);
      far = _mm256_min_ps(_mm256_mul_ps(behind, _mm256_set1_ps(ray.far_rate[a])), far);
    } else {
      const __m256i sign = _mm256_set1_epi32(negative ? -1 : 1);
      const __m256i zero = _mm256_setzero_si256();
      const __m256i ahead = _mm256_max_epi32(
          _mm256_sign_epi32(_mm256_sub_epi32(near_planes, _mm256_set1_epi32(static_cast<int>(
                                                              ray.near_origin[a]))),
                            sign),
          zero);
      const __m256i behind = _mm256_sign_epi32(
          _mm256_sub_epi32(far_planes, _mm256_set1_epi32(static_cast<int>(ray.far_origin[a]))),
          sign);
      const __m256 no_sign = _mm256_castsi256_ps(_mm256_set1_epi32(0x7FFFFFFF));
      const __m256 near_rate = _mm256_and_ps(no_sign, _mm256_set1_ps(ray.near_rate[a]));
      const __m256 far_rate = _mm256_and_ps(no_sign, _mm256_set1_ps(ray.far_rate[a]));
      const __m256 loss =
          corrections<kColumns>(tables.near_bytes.data(), tables.near_words.data(), ray.near_row[a],
                                tables.columns, _mm256_and_si256(ahead, low_mask));
      // A negative distance is a miss and must not be lifted by a correction.
      const __m256i not_behind = _mm256_max_epi32(behind, zero);
      const __m256 gain =
          corrections<kColumns>(tables.far_bytes.data(), tables.far_words.data(), ray.far_row[a],
                                tables.columns, _mm256_and_si256(not_behind, low_mask));
      const __m256 t_ahead = _mm256_sub_ps(_mm256_mul_ps(_mm256_cvtepi32_ps(ahead), near_rate),
                                           _mm256_mul_ps(loss, _mm256_set1_ps(ray.near_unit[a])));
      const __m256 t_behind = _mm256_add_ps(_mm256_mul_ps(_mm256_cvtepi32_ps(behind), far_rate),
                                            _mm256_mul_ps(gain, _mm256_set1_ps(ray.far_unit[a])));
      near = _mm256_max_ps(t_ahead, near);
      far = _mm256_min_ps(t_behind, far);
    }
  }
  const __m256i dropped = _mm256_set1_epi32(static_cast<int>(tables.dropped_bits));
  __m256i near_bits = _mm256_castps_si256(near);
  __m256i far_bits = _mm256_castps_si256(far);
  if constexpr (kNearest) {
    const __m256i half = _mm256_srli_epi32(dropped, 1);
    const __m256i last = _mm256_add_epi32(dropped, _mm256_set1_epi32(1));
    const auto even_up = [&](__m256i bits) A2RT_AVX2 {
      // Adds half - 1, plus one where the last kept bit is set.
      const __m256i kept = _mm256_and_si256(bits, last);
      const __m256i is_zero = _mm256_cmpeq_epi32(kept, _mm256_setzero_si256());
      return _mm256_add_epi32(
          bits, _mm256_add_epi32(half, _mm256_add_epi32(is_zero, _mm256_set1_epi32(1))));
    };
    near_bits = even_up(near_bits);
    far_bits = even_up(far_bits);
  } else {
    far_bits = _mm256_add_epi32(far_bits, dropped);
  }
  near = _mm256_castsi256_ps(_mm256_andnot_si256(dropped, near_bits));
  far = _mm256_castsi256_ps(_mm256_andnot_si256(dropped, far_bits));
  _mm256_storeu_ps(t_near, near);
  return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(near, far, _CMP_LE_OQ)));
}

// The default's kernel: at most 8-bit planes, k = 1..4, conservative rounding. Near and far go
// together, in the two 16-bit halves of each 32-bit lane: one integer multiply-add gives
// magnitude * significand - loss and + gain, the exact integer whose product with the rate's unit
// test_block computes in FP32; a maximum over (near, -far) serves both. Rays that lack the pairs
// (parallel axes, extreme rates) take the general kernel.
A2RT_AVX2 std::uint32_t test_pairs(const QBoxTester::Tables& tables, const GroupRay& ray,
                                   const std::byte* block, float t_left, float* t_near) {
  if (!ray.paired) [[unlikely]] {
    return test_block<false, Columns::kShuffle, false>(tables, ray, block, t_left, t_near);
  }
  constexpr int kFarHalves = 0xAA;  // odd elements
  constexpr std::size_t kHigh = 3 * QBoxTester::kWidth;
  const __m256i zero = _mm256_setzero_si256();
  // Keeps a negative far distance, which is a miss, and clamps the near one.
  const __m256i least = _mm256_set1_epi32(std::numeric_limits<std::int32_t>::min());
  const __m256i low_mask = _mm256_set1_epi16(static_cast<short>(tables.low_mask));
  // A set top bit makes the shuffle give zero: only the low byte of each half is looked up.
  const __m256i no_lookup = _mm256_set1_epi16(-0x8000);
  __m256 first = _mm256_blend_ps(_mm256_setzero_ps(), _mm256_set1_ps(-t_left), kFarHalves);
  __m256 second = first;
  for (unsigned a = 0; a < 3; ++a) {
    const bool negative = (ray.negative >> a & 1U) != 0;
    const std::byte* low = block + a * QBoxTester::kWidth;
    const auto* near_at = reinterpret_cast<const __m128i*>(low + (negative ? kHigh : 0));
    const auto* far_at = reinterpret_cast<const __m128i*>(low + (negative ? 0 : kHigh));
    const __m256i planes =
        _mm256_cvtepu8_epi16(_mm_unpacklo_epi8(_mm_loadl_epi64(near_at), _mm_loadl_epi64(far_at)));
    const __m256i distance = _mm256_sign_epi16(
        _mm256_sub_epi16(planes, _mm256_set1_epi32(static_cast<int>(ray.origin_pair[a]))),
        _mm256_set1_epi16(negative ? -1 : 1));
    const __m256i index =
        _mm256_or_si256(_mm256_and_si256(_mm256_max_epi16(distance, zero), low_mask), no_lookup);
    const auto lookup = [&](const std::vector<std::int8_t>& bytes, std::uint32_t row) A2RT_AVX2 {
      return _mm256_shuffle_epi8(_mm256_broadcastsi128_si256(_mm_loadu_si128(
                                     reinterpret_cast<const __m128i*>(bytes.data()) + row)),
                                 index);
    };
    const __m256i correction =
        _mm256_blend_epi16(lookup(tables.near_bytes, ray.near_row[a]),
                           lookup(tables.far_bytes, ray.far_row[a]), kFarHalves);
    const __m256i magnitude = _mm256_max_epi16(distance, least);
    const __m256i factor = _mm256_broadcastq_epi64(
        _mm_loadl_epi64(reinterpret_cast<const __m128i*>(ray.factor_pair[a])));
    const __m256 unit = _mm256_castsi256_ps(_mm256_broadcastq_epi64(
        _mm_loadl_epi64(reinterpret_cast<const __m128i*>(ray.unit_pair[a]))));
    const __m256i p = _mm256_madd_epi16(_mm256_unpacklo_epi16(magnitude, correction), factor);
    const __m256i q = _mm256_madd_epi16(_mm256_unpackhi_epi16(magnitude, correction), factor);
    first = _mm256_max_ps(_mm256_mul_ps(_mm256_cvtepi32_ps(p), unit), first);
    second = _mm256_max_ps(_mm256_mul_ps(_mm256_cvtepi32_ps(q), unit), second);
  }
  const __m256i dropped = _mm256_set1_epi32(static_cast<int>(tables.dropped_bits));
  const __m256i near_bits =
      _mm256_castps_si256(_mm256_shuffle_ps(first, second, _MM_SHUFFLE(2, 0, 2, 0)));
  const __m256i far_bits = _mm256_add_epi32(
      _mm256_castps_si256(_mm256_xor_ps(_mm256_shuffle_ps(first, second, _MM_SHUFFLE(3, 1, 3, 1)),
                                        _mm256_set1_ps(-0.0F))),
      dropped);
  const __m256 near = _mm256_castsi256_ps(_mm256_andnot_si256(dropped, near_bits));
  const __m256 far = _mm256_castsi256_ps(_mm256_andnot_si256(dropped, far_bits));
  _mm256_storeu_ps(t_near, near);
  return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(near, far, _CMP_LE_OQ)));
}

// Distances of planes and origins fit 16 bits.
bool fits_pairs(const A2rtPrecision& precision) {
  return precision.box_bits <= 8 && precision.multiplier_columns >= 1 &&
         precision.multiplier_columns <= 4 && precision.rounding == QuantRounding::kConservative &&
         precision.min_origin() > -0x4000 && precision.max_origin() < 0x4000;
}

template <bool kWide, Columns kColumns>
QBoxTester::Kernel pick_rounding(QuantRounding rounding) {
  return rounding == QuantRounding::kNearest ? &test_block<kWide, kColumns, true>
                                             : &test_block<kWide, kColumns, false>;
}

template <bool kWide>
QBoxTester::Kernel pick_columns(const A2rtPrecision& precision) {
  if (precision.multiplier_columns == 0) {
    return pick_rounding<kWide, Columns::kExact>(precision.rounding);
  }
  return precision.multiplier_columns <= 4
             ? pick_rounding<kWide, Columns::kShuffle>(precision.rounding)
             : pick_rounding<kWide, Columns::kGather>(precision.rounding);
}

}  // namespace

QBoxTester::Kernel vector_kernel(const A2rtPrecision& precision) {
  const bool fits = precision.direction.fp32_range() && precision.direction.significand_bits <= 10;
  if (!fits || !has_avx2()) {
    return nullptr;
  }
  if (fits_pairs(precision)) {
    return &test_pairs;
  }
  return precision.box_bits > 8 ? pick_columns<true>(precision) : pick_columns<false>(precision);
}

#else

QBoxTester::Kernel vector_kernel(const A2rtPrecision&) { return nullptr; }

#endif

}  // namespace a2rt::arith
