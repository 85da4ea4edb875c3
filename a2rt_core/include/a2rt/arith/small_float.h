// Small floating-point formats (BF16, FP16, reduced significands, FP32) with chosen rounding.
//
// A number of a small format is carried as the FP32 number of the same value, so that comparing
// and scaling need no conversion; encode/decode give the bits a register or the RTL would hold.
#pragma once

#include <cstdint>

#include "a2rt/arith/mutate.h"

namespace a2rt::arith {

// Binary format with a sign bit, gradual underflow, infinities; significand_bits counts the hidden
// bit (BF16: 8).
struct FloatFormat {
  int exponent_bits = 8;
  int significand_bits = 8;

  constexpr int max_exponent() const { return (1 << (exponent_bits - 1)) - 1; }  // of 1.x * 2^e
  constexpr int min_exponent() const { return 1 - max_exponent(); }  // of normal numbers
  constexpr int bits() const { return exponent_bits + significand_bits; }
  // True if FP32 bit masks implement rounding (FP32's own exponent range).
  constexpr bool fp32_range() const { return exponent_bits == 8; }
  friend constexpr bool operator==(const FloatFormat&, const FloatFormat&) = default;
};

inline constexpr FloatFormat kBf16{8, 8};
inline constexpr FloatFormat kFp16{5, 11};
inline constexpr FloatFormat kFp32{8, 24};
// BF16's range with another significand (5..10 bits, hidden bit included).
constexpr FloatFormat reduced_significand(int bits) { return {8, bits}; }

enum class Rounding : std::uint8_t { kTowardZero, kAwayFromZero, kNearestEven };

// Largest finite number of the format.
float max_finite(FloatFormat format);
// Smallest positive normal number.
float min_normal(FloatFormat format);

// Rounds to the format. Never NaN for a non-NaN input. Overflow: towards zero gives the largest
// finite number, away gives infinity, nearest as IEEE 754. Underflow is gradual: away gives at
// least the smallest denormal. Infinity stays infinity. NaN is refused (InternalError).
float round_to(double value, FloatFormat format, Rounding rounding);

// |value| as integer * 2^exponent; for normal numbers the integer has significand_bits bits.
// The value must be finite and of the format.
struct Significand {
  std::uint32_t integer = 0;
  int exponent = 0;
};
Significand split(float value, FloatFormat format);

// Bit pattern in the low format.bits() bits; the value must be of the format (infinity allowed).
std::uint32_t encode(float value, FloatFormat format);
float decode(std::uint32_t bits, FloatFormat format);

}  // namespace a2rt::arith
