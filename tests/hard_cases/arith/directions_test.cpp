// Directions the paper does not mention: parallel to an axis, denormal, enormous.
#include <gtest/gtest.h>

#include <limits>

#include "verdicts.h"

namespace a2rt::arith::hard {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();
const Box kGroup{{-2, -3, -4}, {5, 6, 7}};
const Box kChild{{0, 0, 0}, {1, 2, 3}};

// A ray along `axis` (sign +-1) that passes through (x, y, z), other components `rest`.
Case along(std::size_t axis, float sign, Vec3 through, float rest) {
  Case c{kGroup, kChild, through, {rest, rest, rest}};
  c.direction[axis] = sign;
  c.origin[axis] = -20 * sign;
  return c;
}

TEST(AxisParallel, InsideTheSlabsIsKeptForBothZeros) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const float sign : {1.0F, -1.0F}) {
      for (const float zero : {0.0F, -0.0F}) {
        const Verdicts v = judge(along(axis, sign, {0.5F, 0.5F, 0.5F}, zero));
        EXPECT_TRUE(v.truth);
        EXPECT_TRUE(v.kept()) << v.describe();
      }
    }
  }
}

TEST(AxisParallel, InThePlaneOfAFaceIsKept) {
  for (const Vec3 through : {Vec3{0, 0, 0}, Vec3{1, 2, 3}, Vec3{0, 2, 3}, Vec3{1, 0, 3}}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Verdicts v = judge(along(axis, 1, through, 0));
      EXPECT_TRUE(v.truth);
      EXPECT_TRUE(v.kept()) << v.describe();
    }
  }
}

TEST(AxisParallel, InThePlaneOfTheGroupsOwnFaceIsKept) {
  Case c{kGroup, {{-2, -3, -4}, {0, 0, 0}}, {-2, -1, -30}, {0, 0, 1}};
  EXPECT_TRUE(judge(c).kept()) << judge(c).describe();
  c = {kGroup, {{0, 0, 0}, {5, 6, 7}}, {5, 1, -30}, {0, -0.0F, 1}};
  EXPECT_TRUE(judge(c).kept()) << judge(c).describe();
}

TEST(AxisParallel, TwoLevelsBesideTheBoxIsSeparated) {
  // Levels are at most 11/253 wide here.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const Vec3 through : {Vec3{-0.1F, -0.1F, -0.1F}, Vec3{1.1F, 2.1F, 3.1F}}) {
      const Verdicts v = judge(along(axis, 1, through, 0));
      EXPECT_TRUE(v.separated()) << v.describe();
    }
  }
}

TEST(AxisParallel, Aqb8MissesEverythingBecauseInfinityWrapsToSlopeOne) {
  const Verdicts v = judge(along(0, 1, {0.5F, 0.5F, 0.5F}, 0));
  EXPECT_EQ(v.aqb8, Verdict::kMisses);
  EXPECT_EQ(v.aqb8_rtl, Verdict::kMisses);
}

TEST(ZeroDirection, IsAContainmentTest) {
  EXPECT_TRUE(judge({kGroup, kChild, {1, 2, 3}, {0, 0, 0}}).kept());
  EXPECT_TRUE(judge({kGroup, kChild, {1, 2, 3}, {0, 0, 0}}).truth);
  const Verdicts outside = judge({kGroup, kChild, {1.5F, 2, 3}, {0, 0, 0}});
  EXPECT_TRUE(outside.separated()) << outside.describe();
}

TEST(DenormalDirection, InsideTheSlabsIsKept) {
  for (const float tiny : {0x1p-149F, -0x1p-149F, 0x1.8p-140F, -0x1p-127F, 0x1p-126F}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Verdicts v = judge(along(axis, 1, {0.5F, 0.5F, 0.5F}, tiny));
      EXPECT_TRUE(v.truth);
      EXPECT_TRUE(v.kept()) << v.describe();
    }
  }
}

TEST(DenormalDirection, ABoxThatIsReachedOnlyAfterFltMaxIsKeptIfTmaxIsInfinite) {
  const Case c{kGroup, kChild, {0.5F, 0.5F, -3}, {0, 0, 0x1p-149F}};
  EXPECT_TRUE(judge(c).truth);
  EXPECT_TRUE(judge(c).kept()) << judge(c).describe();
  Case finite = c;
  finite.tmax = 1e30F;
  EXPECT_TRUE(judge(finite).separated()) << judge(finite).describe();
}

TEST(DenormalDirection, AllComponentsDenormalIsKept) {
  const Case c{kGroup, kChild, {-1, -1, -1}, {0x1p-149F, 0x1p-148F, 0x1p-148F}};
  EXPECT_TRUE(judge(c).truth);
  EXPECT_TRUE(judge(c).kept()) << judge(c).describe();
}

TEST(HugeDirection, IsKept) {
  for (const float d : {0x1p60F, 0x1p126F, kLargest}) {
    const Case c{kGroup, kChild, {-1, -1, -1}, {d, d / 2, d / 2}};
    EXPECT_TRUE(judge(c).truth);
    EXPECT_TRUE(judge(c).kept()) << judge(c).describe();
  }
}

TEST(NearAxisDirection, Aqb8LosesHitsBelowTwoToMinusSixteenBecauseItsShiftOverflows) {
  // A distant ray into the middle of a box, y nearly parallel.
  const auto ray_with = [](float small) {
    Case c{{{-1, -1, -1}, {1, 1, 1}},
           {{-0.5F, 0.4F, -0.5F}, {0.5F, 0.6F, 0.5F}},
           {-10, 0.5F, 0},
           {1, small, 0.001F}};
    return judge(c);
  };
  EXPECT_NE(ray_with(0x1.8p-14F).aqb8, Verdict::kMisses);
  EXPECT_EQ(ray_with(0x1.8p-33F).aqb8, Verdict::kMisses);
  for (const float small : {0x1.8p-14F, 0x1.8p-20F, 0x1.8p-33F, -0x1.8p-20F, -0x1.8p-33F}) {
    EXPECT_TRUE(ray_with(small).truth);
    EXPECT_TRUE(ray_with(small).kept()) << ray_with(small).describe();
  }
}

TEST(RateBeyondBf16, DenormalExtentsMakeTheRateHugeAndAreKept) {
  const Box tiny{{0, 0, 0}, {0x1p-140F, 0x1p-149F, 0x1p-130F}};
  const Case c{tiny, tiny, {-0x1p-130F, 0, 0}, {1, 0, 0}};
  EXPECT_TRUE(judge(c).truth);
  EXPECT_TRUE(judge(c).kept()) << judge(c).describe();
}

}  // namespace
}  // namespace a2rt::arith::hard
