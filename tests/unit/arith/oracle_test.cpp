#include "a2rt/arith/oracle.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <limits>

#include "a2rt/hard/strata.h"

namespace a2rt::arith::testing {
namespace {

using namespace a2rt::hard;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(Oracle, FiltersAgreeWithRationalsOnEveryStratum) {
  Random random(3);
  std::array<std::uint64_t, 3> decided{};
  std::uint64_t hits = 0;
  for (std::uint32_t i = 0; i < 40'000; ++i) {
    const Stratum s = stratum(i % kStrata);
    const TestGroup group = make_group(random, s);
    const TestRay ray = make_ray(random, s, group);
    const OracleRay oracle(ray.origin, ray.direction, ray.tmin);
    const Box& box = group.children[random.below(kChildren)];
    OracleStage stage{};
    const bool fast = ray_meets_box(oracle, box, ray.tmax, stage);
    ASSERT_EQ(fast, ray_meets_box_rational(oracle, box, ray.tmax))
        << name_of(s) << ": " << describe(ray) << ", " << describe(box);
    ++decided[static_cast<std::size_t>(stage)];
    hits += fast ? 1U : 0U;
  }
  // Every stage must have been exercised, or this test proves nothing about it.
  EXPECT_GT(decided[0], 30'000U);
  EXPECT_GT(decided[1], 100U);
  EXPECT_GT(decided[2], 10U);
  EXPECT_GT(hits, 5'000U);
}

TEST(Oracle, TouchingCountsAsMeeting) {
  const Box box{{0, 0, 0}, {1, 1, 1}};
  const OracleRay along_face({-1, 1, 0.5F}, {1, 0, 0}, 0);
  EXPECT_TRUE(ray_meets_box(along_face, box, kInfinity));
  EXPECT_TRUE(ray_meets_box(along_face, box, 1));
  EXPECT_FALSE(ray_meets_box(along_face, box, 0x1.fffffep-1F));
  const OracleRay through_corner({-1, 2, 0.5F}, {1, -1, 0}, 0);
  EXPECT_TRUE(ray_meets_box(through_corner, box, kInfinity));
  const OracleRay past_corner({-1, 0x1.000002p1F, 0.5F}, {1, -1, 0}, 0);
  EXPECT_TRUE(ray_meets_box(past_corner, box, kInfinity));
  const OracleRay outside({-1, 3.5F, 0.5F}, {1, -1, 0}, 0);
  EXPECT_FALSE(ray_meets_box(outside, box, kInfinity));
  const OracleRay starts_behind({0.5F, 0.5F, 0.5F}, {1, 0, 0}, 0x1.000002p-1F);
  EXPECT_FALSE(ray_meets_box(starts_behind, box, kInfinity));
}

TEST(Oracle, ZeroDirectionIsAPoint) {
  const Box box{{0, 0, 0}, {1, 1, 1}};
  EXPECT_TRUE(ray_meets_box(OracleRay({1, 1, 1}, {0, -0.0F, 0}, 0), box, kInfinity));
  EXPECT_FALSE(ray_meets_box(OracleRay({1, 1.5F, 1}, {0, 0, 0}, 0), box, kInfinity));
}

TEST(Oracle, StageChecksNoticeABrokenValue) {
  const A2rtPrecision precision;
  const Box group{{0, 0, 0}, {1, 2, 4}};
  const Box child{{0.3F, 0.3F, 0.3F}, {0.7F, 0.7F, 0.7F}};
  GroupFrame frame = make_group_frame(group, precision);
  EXPECT_TRUE(scale_is_safe(group, frame, precision));
  QuantizedBox q = quantize_box(child, group, frame, precision);
  EXPECT_TRUE(box_is_contained(child, q, frame, precision));
  const Box back = dequantize_box(q, frame, precision);
  EXPECT_TRUE(dequantized_is_contained(q, back, frame, precision));
  Box small = back;
  small.hi.z = child.hi.z;
  EXPECT_FALSE(dequantized_is_contained(q, small, frame, precision));
  ++q.lo[1];
  EXPECT_FALSE(box_is_contained(child, q, frame, precision));
  frame.scale.x *= 1.000001F;
  EXPECT_FALSE(scale_is_safe(group, frame, precision));
  const OracleRay ray({-1, 0.5F, 0.5F}, {1, 0.1F, 0}, 0);
  EXPECT_TRUE(shift_is_early(ray, group, 1));
  EXPECT_FALSE(shift_is_early(ray, group, 0x1.000002p0F));
  EXPECT_FALSE(shift_is_early(ray, group, -1));
}

}  // namespace
}  // namespace a2rt::arith::testing
