// AQB8's arithmetic: formats and corners as specified, and its measured loss at small |d|.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "a2rt/arith/aqb8_arith.h"
#include "a2rt/arith/oracle.h"
#include "a2rt/base/error.h"
#include "a2rt/hard/near_axis.h"

namespace a2rt::arith::testing {
namespace {

using namespace a2rt::hard;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::int32_t kIntMin = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kIntMax = std::numeric_limits<std::int32_t>::max();

TEST(Aqb8, ConversionsSaturateAsTheArtifactDoes) {
  EXPECT_EQ(aqb8_floor(-1.5F), -2);
  EXPECT_EQ(aqb8_ceil(-1.5F), -1);
  EXPECT_EQ(aqb8_nearest(2.5F), 2);
  EXPECT_EQ(aqb8_nearest(3.5F), 4);
  EXPECT_EQ(aqb8_floor(0x1p31F), kIntMax);
  EXPECT_EQ(aqb8_floor(-0x1p31F), kIntMin);
  EXPECT_EQ(aqb8_floor(-0x1p40F), kIntMin);
  EXPECT_EQ(aqb8_ceil(0x1.000002p31F), kIntMax);
  EXPECT_EQ(aqb8_ceil(0x1p31F), kIntMin) << "the artifact's hole at exactly 2^31";
  EXPECT_EQ(aqb8_ceil(kInfinity), kIntMax);
  EXPECT_EQ(aqb8_floor(std::nanf("")), kIntMin);
}

TEST(Aqb8, ReciprocalCopiesHoldFiveBitShiftsAndSevenBitFractions) {
  const Aqb8Ray ray = make_aqb8_ray({0, 0, 0}, {0.5F, -0.75F, 1}, 0);
  EXPECT_EQ(ray.low[0], 1U << 7);           // w = 2: shift 1, fraction 0
  EXPECT_EQ(ray.high[0], (1U << 7) + 1);    // always the next value, even if w is exact
  EXPECT_EQ(ray.high[1], 0U << 7 | 0x2AU);  // w = -1.333..: truncated is the high copy
  EXPECT_EQ(ray.low[1], 0U << 7 | 0x2BU);
  EXPECT_EQ(ray.negative, 2);
  EXPECT_EQ(ray.low[2], 0);
  // |d| > 1 wraps the shift: w = 0.5 has exponent -1, kept modulo 32.
  EXPECT_EQ(make_aqb8_ray({0, 0, 0}, {2, 1, 1}, 0).low[0], 31U << 7);
  // d = 0: infinity's exponent 128 wraps to shift 0, slope 1.
  EXPECT_EQ(make_aqb8_ray({0, 0, 0}, {0, 1, 1}, 0).low[0], 0);
}

TEST(Aqb8, AnchorUsesOneStepForAllAxes) {
  const Aqb8Anchor anchor = make_aqb8_anchor({{0, 0, 0}, {1, 2, 255}});
  EXPECT_EQ(anchor.sx, 1);
  EXPECT_EQ(anchor.inv_sx_inv_sw, 128);
  const Aqb8Box q = quantize_aqb8({{0.25F, 0.5F, 3}, {0.5F, 1.5F, 254.5F}}, anchor);
  EXPECT_EQ(q, (Aqb8Box{{0, 0, 3}, {1, 2, 255}}));
  EXPECT_EQ(aqb8_half_area(q, anchor), (1.0F + 2.0F) * 252.0F + 1.0F * 2.0F);
  EXPECT_THROW(make_aqb8_anchor({{1, 1, 1}, {1, 1, 1}}), UserError);
  EXPECT_FALSE(aqb8_can_anchor({{1, 1, 1}, {1, 1, 1}}));
}

TEST(Aqb8, SaturatedLowBoundWrapsTheHighBound) {
  const Aqb8Anchor anchor = make_aqb8_anchor({{0, 0, 0}, {1, 1, 1}});
  const Aqb8Ray ray = make_aqb8_ray({-1, 0.5F, 0.5F}, {1, 0x1p-60F, 0x1p-60F}, 0);
  const Aqb8Local local = aqb8_enter(ray, anchor, 1, kInfinity, Aqb8Rounding::kFloorCeil);
  EXPECT_EQ(local.low[1], kIntMin);
  const Aqb8Ray other = make_aqb8_ray({-1, 0.5F, 0.5F}, {1, -0x1p-60F, 0x1p-60F}, 0);
  const Aqb8Local wrapped = aqb8_enter(other, anchor, 1, kInfinity, Aqb8Rounding::kFloorCeil);
  EXPECT_EQ(wrapped.low[1], kIntMax);
  EXPECT_EQ(wrapped.high[1], kIntMin);
}

TEST(Aqb8, EightBoxesAtOnceAreTestedBitByBitAsOneByOne) {
  std::uint32_t state = 1;
  const auto next = [&] { return state = state * 1664525U + 1013904223U, state >> 8; };
  int hits = 0, misses = 0;
  for (int i = 0; i < 50'000; ++i) {
    Aqb8Ray ray;
    Aqb8Local local;
    Aqb8Block boxes;
    ray.negative = static_cast<std::uint8_t>(next() & 7U);
    // Shifts are small mostly: from 16 on, products leave 32 bits.
    const std::uint32_t copies = i % 4 == 0 ? 0xFFFU : 0x3FFU;
    for (std::size_t a = 0; a < 3; ++a) {
      ray.low[a] = static_cast<std::uint16_t>(next() & copies);
      ray.high[a] = static_cast<std::uint16_t>(next() & copies);
      local.low[a] = static_cast<std::int32_t>(next() % 60'000) - 40'000;
      local.high[a] = i % 9 == 0 ? kIntMin : local.low[a] + 1;
    }
    local.qy_max = i % 5 == 0 ? kIntMax : static_cast<std::int32_t>(next());
    for (std::size_t slot = 0; slot < Aqb8Block::kWidth; ++slot) {
      Aqb8Box box;
      for (std::size_t a = 0; a < 3; ++a) {
        box.lo[a] = static_cast<std::uint8_t>(next());
        box.hi[a] = static_cast<std::uint8_t>(next());
      }
      boxes.put(slot, box);
      ASSERT_EQ(boxes.get(slot), box);
    }
    std::array<std::int32_t, Aqb8Block::kWidth> entry{}, expected{};
    const std::uint32_t hit = aqb8_test_block(ray, local, boxes, entry.data());
    ASSERT_EQ(hit, aqb8_test_block_scalar(ray, local, boxes, expected.data()));
    ASSERT_EQ(entry, expected);
    hits += std::popcount(hit);
    misses += std::popcount(~hit & 0xFFU);
  }
  EXPECT_GT(hits, 5'000);
  EXPECT_GT(misses, 5'000);
}

TEST(Aqb8Loss, NoneAboveTwoToMinusSixteen) {
  for (const Aqb8Rounding rounding : {Aqb8Rounding::kFloorCeil, Aqb8Rounding::kNearestEven}) {
    for (const int exponent : {-2, -6, -10, -14, -15, -16}) {
      const LossRate loss = aqb8_near_axis_loss(exponent, rounding, 20'000);
      EXPECT_EQ(loss.missed, 0U) << "|d| >= 2^" << exponent;
      EXPECT_GT(loss.hits, 15'000U);
    }
  }
}

// Spec aqb8 section 6 item 1: 5 %, 31 %, 60 %, 77 %, 100 % of the rays aimed into a box are lost.
TEST(Aqb8Loss, ReproducesTheTableAtSmallDirections) {
  // Its bands are wide; how far a rate within one may lie from the figure it names.
  const double tolerances[] = {5, 10, 10, 10, 0.5};
  ASSERT_EQ(aqb8_near_axis_table().size(), std::size(tolerances));
  for (std::size_t i = 0; i < std::size(tolerances); ++i) {
    const NearAxisRow& row = aqb8_near_axis_table()[i];
    const LossRate loss = aqb8_near_axis_loss(row.exponent, Aqb8Rounding::kFloorCeil, 20'000);
    std::printf("aqb8 loss at |d| in 2^%d .. 2^%d: %.1f %% (table: %.0f %%)\n", row.exponent,
                row.exponent + 1, loss.percent(), row.percent);
    EXPECT_NEAR(loss.percent(), row.percent, tolerances[i]) << "|d| = 2^" << row.exponent;
  }
}

TEST(Aqb8Loss, EverythingIsLostForAnExactlyZeroDirectionInsideASlab) {
  const Aqb8Anchor anchor = make_aqb8_anchor({{-1, -1, -1}, {1, 1, 1}});
  const Aqb8Box child = quantize_aqb8({{-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F}}, anchor);
  const Aqb8Ray ray = make_aqb8_ray({-3, 0.1F, 0.1F}, {1, 0, 0}, 0);
  const Aqb8Entry entry = aqb8_anchor_test(ray, anchor, kInfinity);
  EXPECT_TRUE(entry.hit) << "fmax and fmin skip the NaN";
  EXPECT_FALSE(aqb8_test(ray,
                         aqb8_enter(ray, anchor, entry.y_ref, kInfinity, Aqb8Rounding::kFloorCeil),
                         child)
                   .hit);
}

}  // namespace
}  // namespace a2rt::arith::testing
