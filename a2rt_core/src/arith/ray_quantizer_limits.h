// Constants of the quantizer's lemmas, shared by its scalar and vector code.
#pragma once

namespace a2rt::arith {

inline constexpr float kUnitRoundoff = 0x1p-24F;  // u: relative rounding error of FP32
// |g| = |d| S is used as computed only inside this range (lemma "rates").
inline constexpr float kLeastRate = 0x1p-112F;
inline constexpr float kMostRate = 0x1p124F;
inline constexpr float kRateNearPad = 1 - 4 * kUnitRoundoff;
inline constexpr float kRateFarPad = 1 + 6 * kUnitRoundoff;
// Lemma "origin".
inline constexpr float kOriginSlack = kUnitRoundoff * (1 + 0x1p-20F);
inline constexpr float kOriginUnderflow = 0x1p-147F;
inline constexpr float kOriginHair = 0x1p-100F;

}  // namespace a2rt::arith
