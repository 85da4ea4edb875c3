#include "a2rt/arith/ray_quantizer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "a2rt/arith/directed.h"
#include "ray_quantizer_limits.h"
#include "ray_quantizer_vector.h"

namespace a2rt::arith {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kAxes = 3;

float floor_small(float x) {  // |x| < 2^23
  const auto truncated = static_cast<float>(static_cast<int>(x));
  return truncated > x ? truncated - 1 : truncated;
}
float ceil_small(float x) { return -floor_small(-x); }

// FP32's unit in the last place for a format with `significand_bits`; 0 for 0 and infinity.
float unit_of(float rate, int significand_bits) {
  const auto bits = std::bit_cast<std::uint32_t>(rate) & 0x7F800000U;
  return bits == 0x7F800000U ? 0.0F : std::ldexp(std::bit_cast<float>(bits), 1 - significand_bits);
}

}  // namespace

QuantizerRay make_quantizer_ray(const Vec3& origin, const Vec3& direction) {
  QuantizerRay ray;
  for (std::size_t a = 0; a < kAxes; ++a) {
    ray.origin[a] = origin[a];
    ray.dir[a] = direction[a];
    ray.negative |= static_cast<std::uint8_t>(direction[a] < 0 ? 1U << a : 0U);
    ray.zero |= static_cast<std::uint8_t>(direction[a] == 0 ? 1U << a : 0U);
  }
  return ray;
}

RayQuantizer::RayQuantizer(const A2rtPrecision& precision)
    : precision_(precision),
      largest_(max_finite(precision.direction)),
      min_origin_(static_cast<float>(precision.min_origin())),
      max_origin_(static_cast<float>(precision.max_origin())),
      offset_(static_cast<float>(precision.offset())) {
  precision.validate();
  if (precision.direction.fp32_range()) {
    dropped_bits_ = (1U << (24 - precision.direction.significand_bits)) - 1;
  }
}

// Towards zero / away from zero for non-negative values. With FP32's exponent range this is a mask:
// FP32's encoding is monotone, and adding the dropped bits carries into the exponent as needed.
float RayQuantizer::round_near(float value) const {
  if (!precision_.direction.fp32_range()) {
    return round_to(value, precision_.direction, Rounding::kTowardZero);
  }
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) & ~dropped_bits_);
}
float RayQuantizer::round_far(float value) const {
  if (!precision_.direction.fp32_range()) {
    return round_to(value, precision_.direction, Rounding::kAwayFromZero);
  }
  return std::bit_cast<float>((std::bit_cast<std::uint32_t>(value) + dropped_bits_) &
                              ~dropped_bits_);
}

// Lemma (rates): m_lo <= M <= m_hi for M = 1/(|d| S) exact.
// For |g| = fl(|d| S) in [2^-112, 2^124] neither g nor 1/g leaves the normal range, so each of the
// two operations errs by at most u = 2^-24 and m = fl(1/g) satisfies
//   m (1-u)/(1+u) <= M <= m (1+u)/(1-u).
// fl(m (1-4u)) <= m (1-4u)(1+u) <= M and fl(m (1+6u)) >= m (1+6u)(1-u) >= M. The rounding to the
// format then goes the same way.
RayQuantizer::Rates RayQuantizer::rates(float dir, float scale) const {
  const float rate = std::fabs(dir) * scale;
  if (!(rate >= kLeastRate && rate <= kMostRate)) [[unlikely]] {
    return substitute_rates(dir, rate);
  }
  const float m = 1.0F / rate;
  if (precision_.rounding == QuantRounding::kNearest) {
    const float nearest = round_to(m, precision_.direction, Rounding::kNearestEven);
    return {nearest, nearest};
  }
  if (precision_.origin == OriginDesign::kLiteral || mutant(Mutant::kReciprocalNotPadded)) {
    return {round_near(m), round_far(m)};
  }
  if (mutant(Mutant::kReciprocalSwapped)) {
    return {round_far(m), round_near(m)};
  }
  return {round_near(m * kRateNearPad), round_far(m * kRateFarPad)};
}

// Outside that range, values that hold for every such rate:
//   d = 0: both infinite; the tester turns the slab into a containment test.
//   |g| < 2^-112: M > 2^111, no upper bound kept. Products with m_lo = 2^111 stay below 2^126, so
//     a near plane ahead is late but never a certain miss: t may exceed FLT_MAX when tmax = inf.
//   |g| > 2^124 (or overflowed): 0 <= M < 2^-123.
RayQuantizer::Rates RayQuantizer::substitute_rates(float dir, float rate) const {
  if (dir == 0) {
    return {kInfinity, kInfinity};
  }
  if (rate < kLeastRate) {
    if (mutant(Mutant::kTinyRateBecomesParallel)) {
      return {kInfinity, kInfinity};
    }
    return {std::min(round_near(0x1p111F), largest_), kInfinity};
  }
  if (mutant(Mutant::kHugeRateKeepsZero)) {
    return {0, 0};
  }
  return {0, round_far(0x1p-123F)};
}

// Lemma (origin): lowest <= c <= highest for c = (o + t d - lo) S exact.
// e = fl(o - lo), p = fl(t d), a = fl(e + p). Rounding to nearest errs by at most u |result|, plus
// 2^-150 where the product underflows (sums do not err then), so the exact A = o + t d - lo obeys
//   |A - a| <= u (|e| + |p| + |a|) + 2^-150.
// bound = u (|e| + |p| + 4|a|) (1 + 2^-20) + 2^-147 also covers its own four roundings, the
// rounding of a -+ bound (u (|a| + bound)) and that of the product with S (u |a| S and 2^-150, the
// latter covered by the final 2^-100). Overflow or NaN anywhere makes the range test fail: the pair
// escapes.
bool RayQuantizer::conservative_origin(const QuantizerRay& ray, const GroupFrame& frame,
                                       float t_shift, float lowest[3], float highest[3]) const {
  bool inside = true;
  for (std::size_t a = 0; a < kAxes; ++a) {
    const float from_lo = ray.origin[a] - frame.lo[a];
    const float moved = t_shift * ray.dir[a];
    const float at = from_lo + moved;
    float bound = (std::fabs(from_lo) + std::fabs(moved) + 4 * std::fabs(at)) * kOriginSlack +
                  kOriginUnderflow;
    if (mutant(Mutant::kOriginNoErrorBound)) {
      bound = 0;
    }
    if (mutant(Mutant::kOriginBoundForgetsShift)) {
      bound = 4 * std::fabs(at) * kOriginSlack;
    }
    const float tiny = mutant(Mutant::kOriginNoErrorBound) ? 0.0F : kOriginHair;
    lowest[a] = (at - bound) * frame.scale[a] - tiny;
    highest[a] = (at + bound) * frame.scale[a] + tiny;
    // These limits keep the conversion to integers in range; the exact ones are tested on the
    // integers, after adding the offset, which would not be exact before.
    inside = inside && lowest[a] > min_origin_ - 2 && highest[a] < max_origin_ + 1;
  }
  if (!inside && !mutant(Mutant::kOriginClampedNotEscaped)) {
    return false;
  }
  for (std::size_t a = 0; a < kAxes; ++a) {
    if (mutant(Mutant::kOriginClampedNotEscaped)) {
      lowest[a] = std::clamp(lowest[a], min_origin_, max_origin_);
      highest[a] = std::clamp(highest[a], min_origin_, max_origin_);
    }
    lowest[a] = mutant(Mutant::kOriginMinTruncates)
                    ? static_cast<float>(static_cast<int>(lowest[a]))
                    : floor_small(lowest[a]);
    highest[a] = mutant(Mutant::kOriginMaxFloor) ? floor_small(highest[a]) : ceil_small(highest[a]);
    lowest[a] += offset_;
    highest[a] += offset_;
    inside = inside && lowest[a] >= min_origin_ && highest[a] <= max_origin_;
  }
  return inside || mutant(Mutant::kOriginClampedNotEscaped);
}

// The literal design (FP32 as printed, clamped) and the nearest rounding of the others.
bool RayQuantizer::plain_origin(const QuantizerRay& ray, const GroupFrame& frame, float t_shift,
                                float lowest[3], float highest[3]) const {
  for (std::size_t a = 0; a < kAxes; ++a) {
    const float point = ray.origin[a] + t_shift * ray.dir[a];
    const float local = (point - frame.lo[a]) * frame.scale[a] + offset_;
    if (precision_.origin == OriginDesign::kLiteral) {
      // !(x > least) also catches NaN.
      const float clamped = !(local > min_origin_) ? min_origin_ : std::min(local, max_origin_);
      lowest[a] = std::floor(clamped);
      highest[a] = std::ceil(clamped);
      if (precision_.rounding == QuantRounding::kNearest) {
        lowest[a] = highest[a] = std::nearbyint(clamped);
      }
      continue;
    }
    if (!(local > min_origin_ - 0.5F && local < max_origin_ + 0.5F)) {
      return false;
    }
    lowest[a] = highest[a] = std::nearbyint(local);
  }
  return true;
}

void RayQuantizer::set_tables(GroupRay& out) const {
  const int significand_bits = precision_.direction.significand_bits;
  const auto row_of = [&](float rate) {
    return std::bit_cast<std::uint32_t>(rate) >> (24 - significand_bits) &
           ((1U << (significand_bits - 1)) - 1);
  };
  for (std::size_t a = 0; a < kAxes; ++a) {
    out.near_unit[a] = unit_of(out.near_rate[a], significand_bits);
    out.far_unit[a] = unit_of(out.far_rate[a], significand_bits);
    out.near_row[a] = row_of(out.near_rate[a]);
    out.far_row[a] = row_of(out.far_rate[a]);
  }
}

GroupEntry RayQuantizer::enter(const QuantizerRay& ray, const GroupFrame& frame, float t_shift,
                               GroupRay& out) const {
  if (precision_.conservative() && precision_.direction.fp32_range()) {
    const VectorQuantizer vector{min_origin_,
                                 max_origin_,
                                 offset_,
                                 dropped_bits_,
                                 precision_.direction.significand_bits,
                                 precision_.multiplier_columns > 0};
    const VectorQuantizer::Result result = vector.enter(ray, frame, t_shift, out);
    if (result != VectorQuantizer::Result::kUnsupported) {
      return result == VectorQuantizer::Result::kQuantized ? GroupEntry::kQuantized
                                                           : GroupEntry::kEscaped;
    }
  }
  return enter_scalar(ray, frame, t_shift, out);
}

GroupEntry RayQuantizer::enter_scalar(const QuantizerRay& ray, const GroupFrame& frame,
                                      float t_shift, GroupRay& out) const {
  float lowest[3];
  float highest[3];
  const bool inside = precision_.conservative()
                          ? conservative_origin(ray, frame, t_shift, lowest, highest)
                          : plain_origin(ray, frame, t_shift, lowest, highest);
  if (!inside) {
    return GroupEntry::kEscaped;
  }
  for (std::size_t a = 0; a < kAxes; ++a) {
    const Rates m = rates(ray.dir[a], frame.scale[a]);
    const bool negative = ray.dir[a] < 0;
    out.near_origin[a] = negative ? lowest[a] : highest[a];
    out.far_origin[a] = negative ? highest[a] : lowest[a];
    out.near_rate[a] = negative ? -m.near : m.near;
    out.far_rate[a] = negative ? -m.far : m.far;
  }
  out.t_shift = t_shift;
  out.negative = ray.negative;
  out.paired = false;
  if (precision_.multiplier_columns > 0 && precision_.direction.fp32_range()) {
    set_tables(out);
  }
  return GroupEntry::kQuantized;
}

// Lemma (remaining): the difference is rounded up in FP32 and away from zero in the format. Capping
// at the largest finite number loses nothing: finite near values never exceed it, and infinite ones
// mark certain misses.
float RayQuantizer::remaining(float t_closest, float t_shift) const {
  if (t_closest == kInfinity) {
    return largest_;
  }
  // Short cut: the format's numbers are FP32 numbers, so the nearest FP32 number, if it lies
  // strictly between two of them, is between the same two as the exact difference.
  const float nearest = t_closest - t_shift;
  const bool faulty = mutant(Mutant::kLeftRoundsDown) || mutant(Mutant::kSubRoundsNearest) ||
                      mutant(Mutant::kResidualIgnored);
  if (!faulty && precision_.rounding == QuantRounding::kConservative &&
      (mutant(Mutant::kLeftShortCutAlways) ||
       (std::bit_cast<std::uint32_t>(nearest) & dropped_bits_) != 0)) {
    return mutant(Mutant::kLeftShortCutTruncates) ? round_near(nearest)
                                                  : std::min(round_far(nearest), largest_);
  }
  const float left =
      mutant(Mutant::kLeftRoundsDown) ? sub_down(t_closest, t_shift) : sub_up(t_closest, t_shift);
  if (precision_.rounding == QuantRounding::kNearest) {
    return std::min(round_to(left, precision_.direction, Rounding::kNearestEven), largest_);
  }
  if (mutant(Mutant::kLeftRoundsDown)) {
    return round_near(left);
  }
  return std::min(round_far(left), largest_);
}

}  // namespace a2rt::arith
