#include <gtest/gtest.h>

#include <array>
#include <bit>

#include "a2rt/rt/fast_triangle.h"
#include "a2rt/workload/driver_triangle.h"
#include "a2rt/workload/synthetic.h"

namespace a2rt::rt {
namespace {

TEST(FastTriangle, IsBitEqualToTheDriversTest) {
  synthetic::Random random(11);
  int hits = 0;
  for (int i = 0; i < 200000; ++i) {
    Triangle triangle;
    for (Vec3& v : triangle.v) {
      v = random.in_box(-1, 1);
    }
    if (i % 5 == 0) {
      triangle.v[2] = triangle.v[i % 2 == 0 ? 0 : 1];  // degenerate
    }
    Vec3 dir = random.in_box(-1, 1);
    if (i % 7 == 0) {
      dir[static_cast<std::size_t>(i) % 3] = i % 2 == 0 ? 0.0F : -0.0F;
    }
    const Vec3 origin = i % 11 == 0 ? triangle.v[0] : random.in_box(-2, 2);
    const DriverTriangleHit expected = DriverTriangleTest(origin, dir)(triangle);
    const AxisTriangle padded[2] = {AxisTriangle(triangle), {}};
    const FastTriangle uut(origin, dir);
    for (const auto find : {&FastTriangle::find, &FastTriangle::find_scalar}) {
      float t = 0;
      bool front = false;
      FastTriangle::Edges edges;
      const bool hit = (uut.*find)(padded, 1, edges) == 0 && uut.ahead(edges, t, front);
      ASSERT_EQ(hit, expected.hit);
      if (hit) {
        ++hits;
        ASSERT_TRUE(std::bit_cast<std::uint32_t>(t) == std::bit_cast<std::uint32_t>(expected.t) ||
                    (std::isnan(t) && std::isnan(expected.t)));
        ASSERT_EQ(front, expected.front);
      }
    }
  }
  EXPECT_GT(hits, 1000);
}

TEST(FastTriangle, FindsTheFirstOfSeveral) {
  const Triangle far_off{{{9, 9, 1}, {9, 8, 1}, {8, 9, 1}}},
      ahead{{{-1, -1, 2}, {1, -1, 2}, {0, 1, 2}}};
  const AxisTriangle padded[5] = {
      AxisTriangle(far_off), AxisTriangle(ahead), AxisTriangle(far_off), AxisTriangle(ahead), {}};
  const FastTriangle uut({0, 0, 0}, {0, 0, 1});
  FastTriangle::Edges edges;
  float t = 0;
  bool front = false;
  EXPECT_EQ(uut.find(padded, 4, edges), 1U);
  EXPECT_TRUE(uut.ahead(edges, t, front));
  EXPECT_EQ(t, 2);
  EXPECT_EQ(uut.find(padded + 2, 2, edges), 1U);
  EXPECT_EQ(uut.find(padded + 2, 1, edges), 1U);
}

TEST(FastTriangle, FindsAmongSeveralWhatTheDriversTestFindsFirst) {
  synthetic::Random random(12);
  std::array<int, 8> found{};  // by place; the last: none
  for (int i = 0; i < 20000; ++i) {
    const auto count = static_cast<std::uint32_t>(i % 8);
    const Vec3 origin = random.in_box(-2, 2), dir = random.in_box(-1, 1);
    const DriverTriangleTest driver(origin, dir);
    AxisTriangle padded[8];
    std::uint32_t first = count;
    for (std::uint32_t k = count; k-- > 0;) {
      Triangle triangle;
      for (Vec3& v : triangle.v) {
        v = random.in_box(-1, 1);
      }
      padded[k] = AxisTriangle(triangle);
      // The line is met by what is behind the origin, too: the driver's test of the other way
      // tells.
      const Vec3 back{-dir.x, -dir.y, -dir.z};
      if (driver(triangle).hit || DriverTriangleTest(origin, back)(triangle).hit) {
        first = k;
      }
    }
    const FastTriangle uut(origin, dir);
    FastTriangle::Edges vector{}, scalar{};
    ASSERT_EQ(uut.find(padded, count, vector), first);
    ASSERT_EQ(uut.find_scalar(padded, count, scalar), first);
    ++found[first < count ? first : 7];
    if (first < count) {
      ASSERT_EQ(vector.u, scalar.u);
      ASSERT_EQ(vector.v, scalar.v);
      ASSERT_EQ(vector.w, scalar.w);
      for (std::size_t v = 0; v < 3; ++v) {
        ASSERT_EQ(vector.z[v], scalar.z[v]);
      }
    }
  }
  for (const int times : found) {
    EXPECT_GT(times, 5);
  }
}

}  // namespace
}  // namespace a2rt::rt
