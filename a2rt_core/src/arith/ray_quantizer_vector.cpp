#include "ray_quantizer_vector.h"

#include <bit>

#include "a2rt/base/vector_support.h"
#include "ray_quantizer_limits.h"

namespace a2rt::arith {

// A build for the mutation check takes the scalar code everywhere: that is where the faults are.
#if A2RT_HAS_X86_VECTORS && !defined(A2RT_MUTATION)

namespace {

constexpr int kAllAxes = 7;

bool on_all_axes(__m128 mask) { return (_mm_movemask_ps(mask) & kAllAxes) == kAllAxes; }

__m128 magnitude(__m128 x) { return _mm_andnot_ps(_mm_set1_ps(-0.0F), x); }

__m128 select(__m128 mask, __m128 yes, __m128 no) {
  return _mm_or_ps(_mm_and_ps(mask, yes), _mm_andnot_ps(mask, no));
}

__m128 with_bits(__m128 x, __m128i keep) { return _mm_and_ps(x, _mm_castsi128_ps(keep)); }

// A frame is six consecutive floats, so four can be loaded from the first and from the third.
static_assert(sizeof(GroupFrame) == 6 * sizeof(float));
__m128 load_lo(const GroupFrame& frame) { return _mm_loadu_ps(&frame.lo.x); }
__m128 load_scale(const GroupFrame& frame) {
  const __m128 last_four = _mm_loadu_ps(&frame.lo.z);
  return _mm_shuffle_ps(last_four, last_four, _MM_SHUFFLE(3, 3, 2, 1));
}

// Near and far of the three axes side by side: x near, x far, y near, ...
void store_pairs(float* out, __m128 near, __m128 far) {
  _mm_storeu_ps(out, _mm_unpacklo_ps(near, far));
  _mm_storeu_ps(out + 4, _mm_unpackhi_ps(near, far));
}

// What the paired kernel reads, from the fields already filled. Origins fit 16 bits where that
// kernel is chosen.
void store_for_pairs(const VectorQuantizer& q, GroupRay& out) {
  const __m128i near_origin = _mm_cvtps_epi32(_mm_load_ps(out.near_origin));
  const __m128i far_origin = _mm_cvtps_epi32(_mm_load_ps(out.far_origin));
  _mm_store_si128(reinterpret_cast<__m128i*>(out.origin_pair),
                  _mm_or_si128(_mm_and_si128(near_origin, _mm_set1_epi32(0xFFFF)),
                               _mm_slli_epi32(far_origin, 16)));
  const auto load = [](const std::uint32_t* row) {
    return _mm_load_si128(reinterpret_cast<const __m128i*>(row));
  };
  const int hidden = 1 << (q.significand_bits - 1);
  const __m128i near_factor = _mm_or_si128(load(out.near_row), _mm_set1_epi32(hidden | -0x10000));
  const __m128i far_factor = _mm_or_si128(load(out.far_row), _mm_set1_epi32(hidden | 0x10000));
  store_pairs(reinterpret_cast<float*>(out.factor_pair), _mm_castsi128_ps(near_factor),
              _mm_castsi128_ps(far_factor));
  store_pairs(&out.unit_pair[0][0], _mm_load_ps(out.near_unit),
              _mm_xor_ps(_mm_load_ps(out.far_unit), _mm_set1_ps(-0.0F)));
}

void store_tables(const VectorQuantizer& q, __m128 rate, float* unit, std::uint32_t* row) {
  // 2^(1 - p) as a number; the rate's exponent alone times it is its last place.
  const float last_place =
      std::bit_cast<float>(static_cast<std::uint32_t>(127 + 1 - q.significand_bits) << 23);
  _mm_store_ps(unit,
               _mm_mul_ps(with_bits(rate, _mm_set1_epi32(0x7F800000)), _mm_set1_ps(last_place)));
  const __m128i shifted =
      _mm_srl_epi32(_mm_castps_si128(rate), _mm_cvtsi32_si128(24 - q.significand_bits));
  _mm_store_si128(reinterpret_cast<__m128i*>(row),
                  _mm_and_si128(shifted, _mm_set1_epi32((1 << (q.significand_bits - 1)) - 1)));
}

}  // namespace

VectorQuantizer::Result VectorQuantizer::enter(const QuantizerRay& ray, const GroupFrame& frame,
                                               float t_shift, GroupRay& out) const {
  const __m128 dir = _mm_load_ps(ray.dir);
  const __m128 scale = load_scale(frame);
  const __m128 from_lo = _mm_sub_ps(_mm_load_ps(ray.origin), load_lo(frame));
  const __m128 moved = _mm_mul_ps(_mm_set1_ps(t_shift), dir);
  const __m128 at = _mm_add_ps(from_lo, moved);
  const __m128 sum = _mm_add_ps(_mm_add_ps(magnitude(from_lo), magnitude(moved)),
                                _mm_mul_ps(_mm_set1_ps(4), magnitude(at)));
  const __m128 bound =
      _mm_add_ps(_mm_mul_ps(sum, _mm_set1_ps(kOriginSlack)), _mm_set1_ps(kOriginUnderflow));
  const __m128 hair = _mm_set1_ps(kOriginHair);
  const __m128 low = _mm_sub_ps(_mm_mul_ps(_mm_sub_ps(at, bound), scale), hair);
  const __m128 high = _mm_add_ps(_mm_mul_ps(_mm_add_ps(at, bound), scale), hair);
  if (!on_all_axes(_mm_and_ps(_mm_cmpgt_ps(low, _mm_set1_ps(min_origin - 2)),
                              _mm_cmplt_ps(high, _mm_set1_ps(max_origin + 1))))) {
    return Result::kEscaped;
  }
  const __m128 one = _mm_set1_ps(1);
  const __m128 low_cut = _mm_cvtepi32_ps(_mm_cvttps_epi32(low));
  const __m128 high_cut = _mm_cvtepi32_ps(_mm_cvttps_epi32(high));
  const __m128 shift = _mm_set1_ps(offset);
  const __m128 lowest =
      _mm_add_ps(_mm_sub_ps(low_cut, _mm_and_ps(_mm_cmpgt_ps(low_cut, low), one)), shift);
  const __m128 highest =
      _mm_add_ps(_mm_add_ps(high_cut, _mm_and_ps(_mm_cmplt_ps(high_cut, high), one)), shift);
  if (!on_all_axes(_mm_and_ps(_mm_cmpge_ps(lowest, _mm_set1_ps(min_origin)),
                              _mm_cmple_ps(highest, _mm_set1_ps(max_origin))))) {
    return Result::kEscaped;
  }

  const __m128 rate = _mm_mul_ps(magnitude(dir), scale);
  if (!on_all_axes(_mm_and_ps(_mm_cmpge_ps(rate, _mm_set1_ps(kLeastRate)),
                              _mm_cmple_ps(rate, _mm_set1_ps(kMostRate))))) {
    return Result::kUnsupported;
  }
  const __m128 m = _mm_div_ps(one, rate);
  const __m128i dropped = _mm_set1_epi32(static_cast<int>(dropped_bits));
  const __m128i kept = _mm_andnot_si128(dropped, _mm_set1_epi32(-1));
  const __m128 near = with_bits(_mm_mul_ps(m, _mm_set1_ps(kRateNearPad)), kept);
  const __m128 far =
      with_bits(_mm_castsi128_ps(_mm_add_epi32(
                    _mm_castps_si128(_mm_mul_ps(m, _mm_set1_ps(kRateFarPad))), dropped)),
                kept);

  const __m128 negative = _mm_cmplt_ps(dir, _mm_setzero_ps());
  const __m128 sign = _mm_and_ps(negative, _mm_set1_ps(-0.0F));
  _mm_store_ps(out.near_origin, select(negative, lowest, highest));
  _mm_store_ps(out.far_origin, select(negative, highest, lowest));
  _mm_store_ps(out.near_rate, _mm_or_ps(near, sign));
  _mm_store_ps(out.far_rate, _mm_or_ps(far, sign));
  if (tables) {
    store_tables(*this, near, out.near_unit, out.near_row);
    store_tables(*this, far, out.far_unit, out.far_row);
    store_for_pairs(*this, out);
  }
  out.t_shift = t_shift;
  out.negative = ray.negative;
  out.paired = tables;
  return Result::kQuantized;
}

#else

VectorQuantizer::Result VectorQuantizer::enter(const QuantizerRay&, const GroupFrame&, float,
                                               GroupRay&) const {
  return Result::kUnsupported;
}

#endif

}  // namespace a2rt::arith
