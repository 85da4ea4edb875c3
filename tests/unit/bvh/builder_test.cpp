#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "a2rt/base/error.h"
#include "a2rt/bvh/address_space.h"
#include "a2rt/bvh/wide_builder.h"
#include "shapes.h"

namespace a2rt::bvh {
namespace {

using synthetic::Shape;

Triangle triangle(float x, float size = 1) { return {{{x, 0, 0}, {x + size, 0, 0}, {x, size, 0}}}; }

WideBvh build_triangles(const std::vector<Triangle>& triangles,
                        const WideBuildConfig& config = {}) {
  return WideBuilder(config).build(std::span<const Triangle>(triangles));
}

// Every active primitive in exactly one leaf, every record but the root one node's child.
void expect_sound(const WideBvh& bvh, std::size_t active, const WideBuildConfig& config) {
  ASSERT_EQ(bvh.order.size(), active);
  EXPECT_EQ(std::set<std::uint32_t>(bvh.order.begin(), bvh.order.end()).size(), active);
  std::vector<int> parents(bvh.records.size(), 0);
  std::vector<int> owners(active, 0);
  for (const BvhRecord& r : bvh.records) {
    if (r.leaf()) {
      EXPECT_LE(r.count, config.max_leaf);
      for (std::uint32_t p = 0; p < r.count; ++p) {
        ++owners.at(r.first + p);
      }
      continue;
    }
    EXPECT_GE(r.count, 2);
    EXPECT_LE(r.count, config.branching);
    for (std::uint32_t c = 0; c < r.count; ++c) {
      ++parents.at(r.first + c);
    }
  }
  EXPECT_TRUE(std::all_of(owners.begin(), owners.end(), [](int n) { return n == 1; }));
  EXPECT_EQ(parents[0], 0);
  EXPECT_TRUE(std::all_of(parents.begin() + 1, parents.end(), [](int n) { return n == 1; }));
  EXPECT_NO_THROW(check_boxes(bvh, "test"));
}

TEST(WideBuilder, EveryShapeGivesASoundTreeAtEveryWidth) {
  for (const Shape kind : {Shape::kSoup, Shape::kTorus, Shape::kGrid, Shape::kSlivers}) {
    for (const unsigned width : {2U, 3U, 6U, 8U}) {
      const WideBuildConfig config{width, width == 3 ? 1U : 7U};
      const Workload w = shape(kind, 700);
      expect_sound(build_triangles(w.blas[0].triangles, config), w.blas[0].triangles.size(),
                   config);
    }
  }
}

TEST(WideBuilder, ChildrenAreContiguousAndBreadthFirst) {
  const WideBvh bvh = build(Shape::kTorus, 2000);
  std::uint32_t next = 1;
  for (const BvhRecord& r : bvh.records) {
    if (!r.leaf()) {
      EXPECT_EQ(r.first, next);
      next += r.count;
    }
  }
  EXPECT_EQ(next, bvh.records.size());
}

TEST(WideBuilder, LeafBoxesAreTightUnionsOfTheirTriangles) {
  const Workload w = shape(Shape::kSoup, 500);
  const WideBvh bvh = build_triangles(w.blas[0].triangles);
  for (const BvhRecord& r : bvh.records) {
    if (r.leaf()) {
      Box box;
      for (std::uint32_t p = 0; p < r.count; ++p) {
        box.include(active_box(w.blas[0].triangles[bvh.order[r.first + p]]));
      }
      EXPECT_EQ(box, r.box);
    }
  }
}

TEST(WideBuilder, NanAndInfinitePrimitivesAreLeftOut) {
  std::vector<Triangle> triangles = {triangle(0), triangle(5), triangle(10)};
  triangles[1].v[2].y = std::numeric_limits<float>::quiet_NaN();
  triangles[2].v[0].x = std::numeric_limits<float>::infinity();
  const WideBvh bvh = build_triangles(triangles);
  ASSERT_EQ(bvh.order.size(), 1U);
  EXPECT_EQ(bvh.order[0], 0U);
}

TEST(WideBuilder, NothingActiveGivesAnEmptyTree) {
  EXPECT_TRUE(build_triangles({}).empty());
  Triangle nan = triangle(0);
  nan.v[0].x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(build_triangles({nan}).empty());
}

TEST(WideBuilder, DegenerateTrianglesAreKept) {
  std::vector<Triangle> points(50, Triangle{{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}});
  points.push_back(triangle(0, 0));
  expect_sound(build_triangles(points), points.size(), {});
}

TEST(WideBuilder, ManyDuplicatesStayWithinTheDepthOfTheStacks) {
  const WideBvh bvh = build_triangles(std::vector<Triangle>(20000, triangle(3)));
  expect_sound(bvh, 20000, {});
  EXPECT_LE(bvh.depth, 40U);
}

TEST(WideBuilder, CoordinatesNearTheEndsOfFp32StillSplit) {
  for (const float scale : {1e38F, 1e-38F, 1e30F}) {
    std::vector<Triangle> triangles;
    for (int i = 0; i < 64; ++i) {
      triangles.push_back(triangle(static_cast<float>(i) / 64 * scale, scale / 128));
    }
    const WideBvh bvh = build_triangles(triangles, {6, 2});
    expect_sound(bvh, 64, {6, 2});
    // A tree that did not look at the coordinates would mix far ends in one leaf.
    for (const BvhRecord& r : bvh.records) {
      if (r.leaf()) {
        EXPECT_LE(r.box.hi.x - r.box.lo.x, scale / 16);
      }
    }
  }
}

TEST(WideBuilder, TwoBuildsAreIdentical) {
  const WideBvh a = build(Shape::kSoup, 3000), b = build(Shape::kSoup, 3000);
  ASSERT_EQ(a.records.size(), b.records.size());
  EXPECT_EQ(a.order, b.order);
  for (std::size_t i = 0; i < a.records.size(); ++i) {
    EXPECT_EQ(a.records[i].box, b.records[i].box);
    EXPECT_EQ(a.records[i].first, b.records[i].first);
  }
}

TEST(WideBuilder, RefusesWidthsAndLeavesItCannotBuild) {
  EXPECT_THROW(WideBuilder({1, 4}), UserError);
  EXPECT_THROW(WideBuilder({9, 4}), UserError);
  EXPECT_THROW(WideBuilder({6, 0}), UserError);
  EXPECT_THROW(WideBuilder({6, 17}), UserError);
}

TEST(CheckBoxes, NamesTheNodeWithAnInvertedOrNanBox) {
  for (const float bad : {-100.0F, std::numeric_limits<float>::quiet_NaN()}) {
    WideBvh bvh = build(Shape::kTorus, 300);
    bvh.records[5].box.hi.y = bad;
    try {
      check_boxes(bvh, "BLAS 7");
      FAIL() << "accepted";
    } catch (const UserError& e) {
      EXPECT_NE(std::string(e.what()).find("BLAS 7, node 5"), std::string::npos) << e.what();
    }
  }
}

TEST(SahCost, ShrinksWhenLeavesMayBeSmaller) {
  EXPECT_LT(sah_cost(build(Shape::kTorus, 5000)), sah_cost(build(Shape::kTorus, 5000, {2, 1})));
}

TEST(AddressSpace, RegionsAreAlignedAndNeverOverlap) {
  AddressSpace space(Bytes{256});
  for (const std::uint64_t size : {1U, 256U, 257U, 0U, 4095U}) {
    space.reserve("r", Bytes{size});
  }
  for (std::size_t i = 0; i < space.regions().size(); ++i) {
    EXPECT_EQ(space.regions()[i].base.value % 256, 0U);
    if (i > 0) {
      const Region& before = space.regions()[i - 1];
      EXPECT_GE(space.regions()[i].base.value, before.base.value + before.bytes.value);
    }
  }
  EXPECT_THROW(AddressSpace(Bytes{48}), UserError);
}

}  // namespace
}  // namespace a2rt::bvh
