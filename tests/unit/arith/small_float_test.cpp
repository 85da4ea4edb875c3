#include "a2rt/arith/small_float.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "a2rt/arith/directed.h"
#include "a2rt/arith/precision.h"
#include "a2rt/base/error.h"

namespace a2rt::arith {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float from_bits(std::uint32_t bits) { return std::bit_cast<float>(bits); }

// Expected roundings by integer arithmetic on FP32 encodings.
std::uint32_t nearest_even(std::uint32_t bits) {
  return (bits + 0x7FFFU + (bits >> 16 & 1U)) & 0xFFFF0000U;
}

TEST(Bf16, EveryValueAndItsSurroundingsRoundAsTheEncodingSays) {
  for (std::uint32_t high = 0; high < 0x7F80U; ++high) {
    for (const std::uint32_t low : {0U, 1U, 0x7FFFU, 0x8000U, 0x8001U, 0xFFFFU}) {
      const std::uint32_t bits = high << 16 | low;
      const float x = from_bits(bits);
      const std::uint32_t away = (bits + 0xFFFFU) & 0xFFFF0000U;
      for (const float sign : {1.0F, -1.0F}) {
        ASSERT_EQ(round_to(sign * x, kBf16, Rounding::kTowardZero), sign * from_bits(high << 16));
        ASSERT_EQ(round_to(sign * x, kBf16, Rounding::kAwayFromZero), sign * from_bits(away));
        ASSERT_EQ(round_to(sign * x, kBf16, Rounding::kNearestEven),
                  sign * from_bits(nearest_even(bits)))
            << std::hex << bits;
      }
    }
  }
}

class EveryEncoding : public ::testing::TestWithParam<FloatFormat> {};

TEST_P(EveryEncoding, SurvivesDecodingAndEncoding) {
  const FloatFormat f = GetParam();
  const std::uint32_t infinity = encode(kInfinity, f);
  for (std::uint32_t bits = 0; bits < 1U << f.bits(); ++bits) {
    const float x = decode(bits, f);
    if (std::isnan(x)) {
      EXPECT_GT(bits & ((1U << (f.bits() - 1)) - 1), infinity);
      continue;
    }
    ASSERT_EQ(encode(x, f), bits);
    for (const Rounding r :
         {Rounding::kTowardZero, Rounding::kAwayFromZero, Rounding::kNearestEven}) {
      ASSERT_EQ(round_to(x, f, r), x) << bits;
    }
    if (std::isfinite(x)) {
      const Significand s = split(x, f);
      ASSERT_EQ(std::ldexp(s.integer, s.exponent), std::fabs(x));
      ASSERT_LT(s.integer, 1U << f.significand_bits);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryEncoding,
                         ::testing::Values(kBf16, kFp16, reduced_significand(5),
                                           reduced_significand(10)),
                         [](const auto& format) { return name_of(format.param); });

TEST(SmallFloat, OverflowStaysFiniteTowardsZeroAndBecomesInfiniteAway) {
  EXPECT_EQ(round_to(70000.0, kFp16, Rounding::kTowardZero), 65504.0F);
  EXPECT_EQ(round_to(65505.0, kFp16, Rounding::kAwayFromZero), kInfinity);
  EXPECT_EQ(round_to(-70000.0, kFp16, Rounding::kTowardZero), -65504.0F);
  EXPECT_EQ(round_to(65519.0, kFp16, Rounding::kNearestEven), 65504.0F);
  EXPECT_EQ(round_to(65520.0, kFp16, Rounding::kNearestEven), kInfinity);
  EXPECT_EQ(round_to(kInfinity, kBf16, Rounding::kTowardZero), kInfinity);
}

TEST(SmallFloat, UnderflowIsGradual) {
  EXPECT_EQ(round_to(0x1p-30, kFp16, Rounding::kTowardZero), 0.0F);
  EXPECT_EQ(round_to(0x1p-30, kFp16, Rounding::kAwayFromZero), 0x1p-24F);
  EXPECT_EQ(round_to(0x1.8p-24, kFp16, Rounding::kNearestEven), 0x1p-23F);
  EXPECT_EQ(round_to(0x1p-140, kBf16, Rounding::kAwayFromZero), 0x1p-133F);
}

TEST(SmallFloat, NanIsRefused) {
  EXPECT_THROW(round_to(std::numeric_limits<double>::quiet_NaN(), kBf16, Rounding::kTowardZero),
               InternalError);
  EXPECT_THROW(split(kInfinity, kBf16), InternalError);
}

TEST(Directed, NextUpWalksEveryNeighbour) {
  // All exponents, a few numbers each, against the library's nextafter.
  for (std::uint32_t bits = 0; bits < 0x7F800000U; bits += 0x1234U) {
    const float x = from_bits(bits);
    ASSERT_EQ(next_up(x), std::nextafter(x, kInfinity));
    ASSERT_EQ(next_down(x), std::nextafter(x, -kInfinity));
    ASSERT_EQ(next_up(-x), std::nextafter(-x, kInfinity));
  }
  EXPECT_EQ(next_up(std::numeric_limits<float>::max()), kInfinity);
  EXPECT_EQ(next_down(kInfinity), std::numeric_limits<float>::max());
  EXPECT_EQ(next_up(-kInfinity), -std::numeric_limits<float>::max());
}

TEST(Directed, OverflowRoundsToTheLargestFiniteOrToInfinity) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  EXPECT_EQ(add_down(kLargest, kLargest), kLargest);
  EXPECT_EQ(add_up(kLargest, kLargest), kInfinity);
  EXPECT_EQ(mul_down(-kLargest, 2), -kInfinity);
  EXPECT_EQ(mul_up(-kLargest, 2), -kLargest);
  EXPECT_EQ(rcp_down(0x1p-149F), kLargest);
}

TEST(Precision, ImpossibleKnobsAreRefusedByName) {
  const auto message_of = [](const A2rtPrecision& p) {
    try {
      p.validate("unit.toml");
    } catch (const UserError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  A2rtPrecision p;
  EXPECT_EQ(message_of(p), "");
  p.box_bits = 13;
  EXPECT_EQ(message_of(p), "unit.toml: box_bits = 13 is not possible; use 4 to 12");
  p = {};
  p.origin_bits = 8;
  EXPECT_NE(message_of(p).find("origin_bits = 8"), std::string::npos);
  p = {};
  p.multiplier_columns = 9;
  EXPECT_NE(message_of(p).find("multiplier_columns = 9"), std::string::npos);
  p = {};
  p.direction = {6, 9};
  EXPECT_NE(message_of(p).find("use bf16, fp16, fp32 or s5 to s10"), std::string::npos);
  EXPECT_THROW(float_format_from("bf17"), UserError);
}

TEST(Precision, DerivedRangesFollowTheDesign) {
  A2rtPrecision wide;
  EXPECT_EQ(wide.steps(), 255);
  EXPECT_EQ(wide.min_origin(), -512);
  EXPECT_EQ(wide.max_origin(), 511);
  EXPECT_EQ(wide.magnitude_bits(), 10);
  A2rtPrecision guard;
  guard.origin = OriginDesign::kGuard;
  EXPECT_EQ(guard.steps(), 253);
  EXPECT_EQ(guard.offset(), 1);
  EXPECT_EQ(guard.max_origin(), 255);
  EXPECT_EQ(guard.magnitude_bits(), 8);
}

TEST(Precision, NamesRoundTrip) {
  for (const char* name : {"bf16", "fp16", "fp32", "s5", "s6", "s7", "s9", "s10"}) {
    EXPECT_EQ(name_of(float_format_from(name)), name);
  }
  for (const char* name : {"wide", "guard", "literal"}) {
    EXPECT_EQ(name_of(origin_design_from(name)), name);
  }
}

}  // namespace
}  // namespace a2rt::arith
