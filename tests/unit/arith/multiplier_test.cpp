#include "a2rt/arith/multiplier.h"

#include <gtest/gtest.h>

#include <cmath>

#include "a2rt/base/error.h"

namespace a2rt::arith {
namespace {

// Parameters: magnitude bits, columns, mode.
using Configuration = std::tuple<int, int, LowColumns>;

class EveryOperand : public ::testing::TestWithParam<Configuration> {};

// The definition of multiplier.h, written a second time as a bit array.
struct BitArray {
  std::uint64_t low = 0, high = 0;
};
BitArray by_definition(std::uint32_t a, std::uint32_t b, int n, int p, int k, LowColumns mode) {
  std::uint64_t upper = 0;
  std::uint64_t low_part = 0;
  std::uint64_t high_part = 0;
  std::uint64_t worst = 0;
  bool carry = false;
  for (int c = 0; c < n + p - 1; ++c) {
    int height = 0;
    int ones = 0;
    for (int i = 0; i < p; ++i) {
      if (c - i >= 0 && c - i < n) {
        ++height;
        ones += static_cast<int>((b >> i & 1U) & (a >> (c - i) & 1U));
      }
    }
    const std::uint64_t weight = std::uint64_t{1} << c;
    if (c >= k) {
      upper += static_cast<std::uint64_t>(ones) * weight;
      continue;
    }
    const bool drop = mode == LowColumns::kDrop;
    const int loss = drop ? height : height - 1;
    worst += static_cast<std::uint64_t>(loss) * weight;
    carry = carry || (ones > 0 && loss > 0);
    low_part += !drop && ones == height ? weight : 0;
    high_part += !drop && ones > 0 ? weight : 0;
  }
  const std::uint64_t unit = std::uint64_t{1} << k;
  high_part += carry ? (worst + unit - 1) / unit * unit : 0;
  return {upper + low_part, upper + high_part};
}

TEST_P(EveryOperand, MatchesTheBitArrayAndBoundsTheExactProduct) {
  const auto [n, k, mode] = GetParam();
  const ApproxMultiplier multiplier(n, 8, k, mode);
  for (std::uint32_t b = 128; b < 256; ++b) {
    for (std::uint32_t a = 0; a < 1U << n; ++a) {
      const std::uint64_t low = multiplier.low(a, b);
      const std::uint64_t high = multiplier.high(a, b);
      const std::uint64_t exact = static_cast<std::uint64_t>(a) * b;
      ASSERT_LE(low, exact) << a << " * " << b;
      ASSERT_GE(high, exact) << a << " * " << b;
      if (a % 3 == 0 || n <= 9) {
        const BitArray expected = by_definition(a, b, n, 8, k, mode);
        ASSERT_EQ(low, expected.low) << a << " * " << b;
        ASSERT_EQ(high, expected.high) << a << " * " << b;
      }
    }
  }
}

std::string configuration_name(const ::testing::TestParamInfo<Configuration>& info) {
  const auto [n, k, mode] = info.param;
  return "n" + std::to_string(n) + "k" + std::to_string(k) + name_of(mode);
}

INSTANTIATE_TEST_SUITE_P(Compress, EveryOperand,
                         ::testing::Combine(::testing::Values(8, 9, 10, 12), ::testing::Range(0, 9),
                                            ::testing::Values(LowColumns::kCompress)),
                         configuration_name);
INSTANTIATE_TEST_SUITE_P(Drop, EveryOperand,
                         ::testing::Combine(::testing::Values(8, 10), ::testing::Range(0, 9),
                                            ::testing::Values(LowColumns::kDrop)),
                         configuration_name);

TEST(Multiplier, ProductsAreNormalisedToBf16InTheirDirectionForEveryOperand) {
  A2rtPrecision exact;
  exact.multiplier_columns = 0;
  const IntFloatMultiplier multiplier(exact);
  for (std::uint32_t b = 128; b < 256; ++b) {
    const auto rate = static_cast<float>(std::ldexp(b, -20));
    for (std::uint32_t a = 0; a < 1024; ++a) {
      const double product = static_cast<double>(a) * rate;
      ASSERT_EQ(multiplier.near(a, rate), round_to(product, kBf16, Rounding::kTowardZero));
      ASSERT_EQ(multiplier.far(a, rate), round_to(product, kBf16, Rounding::kAwayFromZero));
    }
  }
}

TEST(Multiplier, ErrorGrowsWithTheColumnsAndIsZeroWithoutThem) {
  double previous_low = 0;
  double previous_high = 0;
  for (int k = 0; k <= 8; ++k) {
    const MultiplierErrors e = multiplier_errors(ApproxMultiplier(10, 8, k), 10, 8, false);
    EXPECT_EQ(k <= 1, e.low.worst == 0) << k;  // column 0 holds a single bit: nothing to compress
    EXPECT_EQ(k <= 1, e.high.worst == 0) << k;
    EXPECT_GE(e.low.mean, previous_low);
    EXPECT_GE(e.high.mean, previous_high);
    previous_low = e.low.mean;
    previous_high = e.high.mean;
  }
  EXPECT_GT(previous_low, 0.01);
}

TEST(Multiplier, FourColumnsErrByLessThanHalfALevel) {
  const MultiplierErrors e = multiplier_errors(ApproxMultiplier(10, 8, 4), 10, 8, false);
  EXPECT_LT(e.low.worst_levels, 0.5);
  EXPECT_LT(e.high.worst_levels, 0.5);
}

TEST(Multiplier, OutOfRangeParametersAreRefused) {
  EXPECT_THROW(ApproxMultiplier(0, 8, 0), InternalError);
  EXPECT_THROW(ApproxMultiplier(10, 25, 0), InternalError);
  EXPECT_THROW(ApproxMultiplier(10, 8, 9), InternalError);
}

}  // namespace
}  // namespace a2rt::arith
