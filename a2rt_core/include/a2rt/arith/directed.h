// FP32 operations rounded down or up, without touching the floating-point environment.
//
// All results are the correctly rounded ones (IEEE 754 roundTowardNegative / roundTowardPositive)
// for finite inputs, denormals and overflow included: rounding down never exceeds the exact value
// (positive overflow gives FLT_MAX, negative overflow gives -inf), rounding up mirrors it.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "a2rt/arith/mutate.h"

namespace a2rt::arith {

// Next FP32 number towards +inf; +inf stays. NaN is not accepted by any function of this header.
constexpr float next_up(float x) {
  if (x == 0.0F) {
    return std::numeric_limits<float>::denorm_min();
  }
  const auto bits = std::bit_cast<std::uint32_t>(x);
  if (bits == 0x7F800000U) {
    return x;
  }
  return std::bit_cast<float>(x > 0 ? bits + 1 : bits - 1);
}
constexpr float next_down(float x) { return -next_up(-x); }

// Directed conversion of the exact value `rounded + residual`, where |residual| is at most half a
// unit in the last place of `rounded` (FP64).
// Why: f = RN(rounded). If f > rounded, then f >= the next FP64 number > exact, and the FP32 number
// below f is < rounded, hence <= exact: it is the answer. If f < rounded, likewise f <= exact and
// the next FP32 number is > exact. If f == rounded the residual's sign decides. The conversion
// itself maps overflow to inf, whose lower neighbour is FLT_MAX.
inline float round_down(double rounded, double residual = 0) {
  const auto f = static_cast<float>(rounded);
  const double back = f;
  if (mutant(Mutant::kResidualIgnored)) {
    residual = 0;
  }
  return back > rounded || (back == rounded && residual < 0) ? next_down(f) : f;
}
inline float round_up(double rounded, double residual = 0) {
  return -round_down(-rounded, -residual);
}

// FP64 sum with its exact error (Knuth's TwoSum). Exact for all FP32 inputs: FP64 sums of FP32
// numbers neither overflow nor underflow.
struct ExactSum {
  double sum, error;
};
constexpr ExactSum two_sum(double a, double b) {
  const double s = a + b;
  const double bb = s - a;
  return {s, (a - (s - bb)) + (b - bb)};
}

inline float add_down(float a, float b) {
  const ExactSum s = two_sum(a, b);
  return round_down(s.sum, s.error);
}
inline float add_up(float a, float b) {
  const ExactSum s = two_sum(a, b);
  return round_up(s.sum, s.error);
}
inline float sub_down(float a, float b) {
  if (mutant(Mutant::kSubRoundsNearest)) {
    return a - b;
  }
  return add_down(a, -b);
}
inline float sub_up(float a, float b) {
  if (mutant(Mutant::kSubRoundsNearest)) {
    return a - b;
  }
  return add_up(a, -b);
}

// The FP64 product of two FP32 numbers is exact: 48 significant bits, exponent within -298..256.
inline float mul_down(float a, float b) {
  if (mutant(Mutant::kMulRoundsNearest)) {
    return a * b;
  }
  return round_down(static_cast<double>(a) * b);
}
inline float mul_up(float a, float b) {
  if (mutant(Mutant::kMulRoundsNearest)) {
    return a * b;
  }
  return round_up(static_cast<double>(a) * b);
}

// No residual is needed: if a/b is not an FP32 number f, then |a - f b| is at least one unit of
// the product's last place, so |a/b - f| >= 2^-48 |f|, far more than the 2^-53 |f| by which the
// FP64 quotient errs. Hence the FP64 quotient equals an FP32 number only when the division is
// exact, and otherwise lies on the right side of every FP32 number. b must not be zero.
inline float div_down(float a, float b) {
  if (mutant(Mutant::kDivRoundsNearest)) {
    return a / b;
  }
  return round_down(static_cast<double>(a) / b);
}
inline float div_up(float a, float b) {
  if (mutant(Mutant::kDivRoundsNearest)) {
    return a / b;
  }
  return round_up(static_cast<double>(a) / b);
}
inline float rcp_down(float b) { return div_down(1.0F, b); }
inline float rcp_up(float b) { return div_up(1.0F, b); }

}  // namespace a2rt::arith
