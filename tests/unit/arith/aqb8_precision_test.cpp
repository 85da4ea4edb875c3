// AQB8's precision knobs cut what they say, on the safe side of the same planes and slopes.
#include <gtest/gtest.h>

#include "a2rt/arith/aqb8_arith.h"

namespace a2rt::arith {
namespace {

TEST(Aqb8Precision, FewerBoxBitsWidenTheStep) {
  const Box group{{0, 0, 0}, {255, 255, 255}};
  const Aqb8Precision four{4, 8};
  const Aqb8Anchor fine = make_aqb8_anchor(group), coarse = make_aqb8_anchor(group, "g", four);
  EXPECT_EQ(fine.sx, 1);
  EXPECT_EQ(coarse.sx, 17);
  const Box child{{18, 0, 100}, {33, 254, 101}};
  EXPECT_EQ(quantize_aqb8(child, fine), (Aqb8Box{{18, 0, 100}, {33, 254, 101}}));
  const Aqb8Box stored = quantize_aqb8(child, coarse);
  EXPECT_EQ(stored, (Aqb8Box{{1, 0, 5}, {2, 15, 6}}));
  const Box kept = dequantize_aqb8(stored, coarse);
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_LE(kept.lo[a], child.lo[a]);
    EXPECT_GE(kept.hi[a], child.hi[a]);
  }
}

TEST(Aqb8Precision, FewerSlopeBitsCutTheNearCopyAndRaiseTheFarOne) {
  // w = -1.333..: eight bits keep 0x2A of the fraction, five bits 0x28; the next one is 0x30.
  const Aqb8Ray ray = make_aqb8_ray({0, 0, 0}, {1, -0.75F, 1}, 0, {8, 5});
  EXPECT_EQ(ray.high[1], 0x28U);
  EXPECT_EQ(ray.low[1], 0x30U);
  // The largest fraction carries into the shift.
  const Aqb8Ray carry = make_aqb8_ray({0, 0, 0}, {1 / 1.99F, 1, 1}, 0, {8, 5});
  EXPECT_EQ(carry.low[0], 0x78U);
  EXPECT_EQ(carry.high[0], 1U << 7);
}

}  // namespace
}  // namespace a2rt::arith
