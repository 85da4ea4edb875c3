// What the encoders refuse, and how they say so.
#include <gtest/gtest.h>

#include <limits>

#include "a2rt/arith/aqb8_arith.h"
#include "a2rt/arith/pow2_frame.h"
#include "a2rt/arith/quantized_box.h"
#include "a2rt/arith/slab.h"
#include "a2rt/base/error.h"

namespace a2rt::arith {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kLargest = std::numeric_limits<float>::max();

const Box kUnit{{0, 0, 0}, {1, 1, 1}};

std::string refusal(const Box& box) {
  try {
    make_group_frame(box, A2rtPrecision{}, "node 17");
  } catch (const UserError& e) {
    return e.what();
  }
  return "";
}

TEST(Encoders, RefuseInvertedEmptyAndNonFiniteBoxesByName) {
  EXPECT_EQ(refusal(kUnit), "");
  for (const Box& bad : {Box{}, Box{{0, 2, 0}, {1, 1, 1}}, Box{{0, kNan, 0}, {1, 1, 1}},
                         Box{{0, 0, 0}, {1, kInfinity, 1}}, Box{{0, 0, 0}, {1, 1, kNan}}}) {
    EXPECT_NE(refusal(bad).find("node 17: box is empty, inverted or not finite on the"),
              std::string::npos);
    EXPECT_THROW(make_pow2_frame(bad), UserError);
    EXPECT_THROW(make_aqb8_anchor(bad), UserError);
    EXPECT_FALSE(aqb8_can_anchor(bad) && bad.valid() && bad.hi.y < kInfinity && bad.hi.z == 1);
  }
}

TEST(Encoders, RefuseChildrenOutsideTheirParent) {
  const A2rtPrecision precision;
  const GroupFrame frame = make_group_frame(kUnit, precision);
  const Box outside{{0, 0, 0}, {1, 1, 3}};
  EXPECT_THROW(quantize_box(outside, kUnit, frame, precision, "sub node 3"), UserError);
  EXPECT_THROW(quantize_pow2(outside, make_pow2_frame(kUnit)), UserError);
  EXPECT_THROW(quantize_aqb8(outside, make_aqb8_anchor(kUnit)), UserError);
}

TEST(Frames, FlatAxesTakeTheFinestOtherScale) {
  const A2rtPrecision precision;
  const GroupFrame flat = make_group_frame({{0, 3, 0}, {10, 3, 1}}, precision);
  EXPECT_EQ(flat.scale.z, 255);
  EXPECT_EQ(flat.scale.x, 25.5F);
  EXPECT_EQ(flat.scale.y, 16 * flat.scale.z);
  A2rtPrecision guard;
  guard.origin = OriginDesign::kGuard;
  const GroupFrame guarded = make_group_frame({{0, 3, 0}, {10, 3, 1}}, guard);
  EXPECT_EQ(guarded.scale.y, guarded.scale.z);
  const GroupFrame point = make_group_frame({{1, 2, 3}, {1, 2, 3}}, precision);
  EXPECT_EQ(point.scale, (Vec3{1, 1, 1}));
}

TEST(Frames, ExtremeExtentsHaveFiniteNormalScales) {
  const A2rtPrecision precision;
  const GroupFrame frame =
      make_group_frame({{-kLargest, 0, 0}, {kLargest, 0x1p-149F, 0x1p-140F}}, precision);
  EXPECT_GE(frame.scale.x, std::numeric_limits<float>::min());
  EXPECT_EQ(frame.scale.y, kLargest);
  EXPECT_EQ(frame.scale.z, kLargest);
}

TEST(Frames, SingleScaleIsTheCoarsest) {
  A2rtPrecision precision;
  precision.scales = ScaleSharing::kSingle;
  const GroupFrame frame = make_group_frame({{0, 0, 0}, {1, 2, 5}}, precision);
  EXPECT_EQ(frame.scale, (Vec3{51, 51, 51}));
}

TEST(Rays, InactiveRaysAreRecognised) {
  EXPECT_TRUE(ray_is_active({0, 0, 0}, {1, 0, 0}, 0, kInfinity));
  EXPECT_TRUE(ray_is_active({0, 0, 0}, {1, 0, 0}, 2, 2));
  EXPECT_FALSE(ray_is_active({0, 0, 0}, {1, 0, 0}, 3, 2));
  EXPECT_FALSE(ray_is_active({0, kNan, 0}, {1, 0, 0}, 0, 1));
  EXPECT_FALSE(ray_is_active({0, 0, 0}, {1, kInfinity, 0}, 0, 1));
  EXPECT_FALSE(ray_is_active({0, 0, 0}, {1, 0, 0}, 0, kNan));
  EXPECT_FALSE(ray_is_active({0, 0, 0}, {1, 0, 0}, kInfinity, kInfinity));
}

}  // namespace
}  // namespace a2rt::arith
