#include "a2rt/arith/small_float.h"

#include <bit>
#include <cmath>
#include <limits>

#include "a2rt/base/error.h"

namespace a2rt::arith {
namespace {

// 2^e for any e that FP64 holds as a normal number.
double power_of_two(int e) { return std::ldexp(1.0, e); }

// `scaled` >= 0 to an integer. Exact: FP64 integers up to 2^53 are, and formats have <= 24 bits.
double round_integer(double scaled, Rounding rounding) {
  switch (rounding) {
    case Rounding::kTowardZero:
      if (mutant(Mutant::kTruncateKeepsOneBitMore)) {
        return std::floor(scaled * 2) / 2;
      }
      return std::floor(scaled);
    case Rounding::kAwayFromZero:
      if (mutant(Mutant::kAwayForgetsSticky)) {
        return std::floor(scaled + 0.5);
      }
      if (mutant(Mutant::kAwayAlwaysSteps)) {
        return std::floor(scaled) + 1;
      }
      return std::ceil(scaled);
    case Rounding::kNearestEven:
      break;
  }
  const double below = std::floor(scaled);
  const double rest = scaled - below;
  const bool up = rest > 0.5 || (rest == 0.5 && std::fmod(below, 2) != 0);
  return up ? below + 1 : below;
}

constexpr int kStoredBits = 52;  // of FP64
constexpr int kBias = 1023;

// Short cut of round_to() for results that neither under- nor overflow: FP64's encoding is
// monotone, so that dropping or adding the bits the format lacks rounds, with carries into the
// exponent as needed.
double round_bits(std::uint64_t bits, int significand_bits, Rounding rounding) {
  const int lacking = kStoredBits + 1 - significand_bits;
  const std::uint64_t dropped = (std::uint64_t{1} << lacking) - 1;
  switch (rounding) {
    case Rounding::kTowardZero:
      break;
    case Rounding::kAwayFromZero:
      bits += dropped;
      break;
    case Rounding::kNearestEven:
      bits += (dropped >> 1) + (bits >> lacking & 1);
      break;
  }
  return std::bit_cast<double>(bits & ~dropped);
}

bool rounding_is_faulty() {
  return mutant(Mutant::kTruncateKeepsOneBitMore) || mutant(Mutant::kAwayForgetsSticky) ||
         mutant(Mutant::kAwayAlwaysSteps);
}

}  // namespace

float max_finite(FloatFormat format) {
  return static_cast<float>((2 - power_of_two(1 - format.significand_bits)) *
                            power_of_two(format.max_exponent()));
}

float min_normal(FloatFormat format) {
  return static_cast<float>(power_of_two(format.min_exponent()));
}

float round_to(double value, FloatFormat format, Rounding rounding) {
  A2RT_CHECK(!std::isnan(value), "NaN reached a rounding to a small format");
  if (std::isinf(value) || value == 0) {
    return static_cast<float>(value);
  }
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const int quick = static_cast<int>(bits >> kStoredBits & 0x7FFU) - kBias;
  if (quick >= format.min_exponent() && quick < format.max_exponent() && !rounding_is_faulty())
      [[likely]] {
    return static_cast<float>(round_bits(bits, format.significand_bits, rounding));
  }
  const double magnitude = std::fabs(value);
  int exponent = std::ilogb(magnitude);
  exponent = exponent < format.min_exponent() ? format.min_exponent() : exponent;
  // Scaling by powers of two is exact: |value| >= 2^-1000 for everything the project multiplies.
  const int quantum = exponent - (format.significand_bits - 1);
  double result = std::ldexp(round_integer(std::ldexp(magnitude, -quantum), rounding), quantum);
  if (mutant(Mutant::kUnderflowFlushesAway) && magnitude < min_normal(format)) {
    result = 0;
  }
  if (result > max_finite(format)) {
    const bool stays_finite =
        rounding == Rounding::kTowardZero && !mutant(Mutant::kOverflowTowardZeroGivesInf);
    result = stays_finite ? max_finite(format) : std::numeric_limits<double>::infinity();
  }
  return static_cast<float>(std::copysign(result, value));
}

Significand split(float value, FloatFormat format) {
  A2RT_CHECK(std::isfinite(value), "only finite numbers have a significand");
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const int quick = static_cast<int>(bits >> 23U & 0xFFU) - 127;
  if (quick >= format.min_exponent()) [[likely]] {
    // A normal number of the format is one of FP32, whose lowest bits are then zeros.
    const std::uint32_t significand = (bits & 0x7FFFFFU) | 0x800000U;
    return {significand >> (24 - format.significand_bits), quick - (format.significand_bits - 1)};
  }
  const double magnitude = std::fabs(static_cast<double>(value));
  if (magnitude == 0) {
    return {0, format.min_exponent() - (format.significand_bits - 1)};
  }
  int exponent = std::ilogb(magnitude);
  exponent = exponent < format.min_exponent() ? format.min_exponent() : exponent;
  const int quantum = exponent - (format.significand_bits - 1);
  return {static_cast<std::uint32_t>(std::ldexp(magnitude, -quantum)), quantum};
}

std::uint32_t encode(float value, FloatFormat format) {
  A2RT_CHECK(!std::isnan(value), "NaN has no encoding in a small format");
  const std::uint32_t sign = std::signbit(value) ? 1U << (format.bits() - 1) : 0U;
  const int stored = format.significand_bits - 1;
  const auto all_ones = static_cast<std::uint32_t>((1 << format.exponent_bits) - 1);
  if (std::isinf(value)) {
    return sign | all_ones << stored;
  }
  const Significand s = split(value, format);
  const std::uint32_t hidden = 1U << stored;
  if (s.integer < hidden) {
    return sign | s.integer;
  }
  const int biased = s.exponent + stored + format.max_exponent();
  return sign | static_cast<std::uint32_t>(biased) << stored | (s.integer - hidden);
}

float decode(std::uint32_t bits, FloatFormat format) {
  const int stored = format.significand_bits - 1;
  const std::uint32_t fraction = bits & ((1U << stored) - 1);
  const auto biased = static_cast<int>(bits >> stored & ((1U << format.exponent_bits) - 1));
  const bool negative = (bits >> (format.bits() - 1) & 1) != 0;
  double magnitude = 0;
  if (biased == (1 << format.exponent_bits) - 1) {
    magnitude = fraction == 0 ? std::numeric_limits<double>::infinity()
                              : std::numeric_limits<double>::quiet_NaN();
  } else if (biased == 0) {
    magnitude = std::ldexp(fraction, format.min_exponent() - stored);
  } else {
    magnitude = std::ldexp(fraction + (1U << stored), biased - format.max_exponent() - stored);
  }
  return static_cast<float>(negative ? -magnitude : magnitude);
}

}  // namespace a2rt::arith
