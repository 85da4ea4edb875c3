#include "a2rt/bvh/classify.h"

#include <gtest/gtest.h>

#include "shapes.h"

namespace a2rt::bvh {
namespace {

using synthetic::Shape;

double length(const Box& b, std::size_t a) {
  return static_cast<double>(b.hi[a]) - static_cast<double>(b.lo[a]);
}

// Equation 5 as printed, with divisions.
bool equation5(const Box& child, const Box& group, const ClassifyConfig& config) {
  if (half_area(group) > 0 && half_area(child) / half_area(group) < config.area_ratio) {
    return false;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    if (length(group, a) > 0 && length(child, a) / length(group, a) < config.length_ratio) {
      return false;
    }
  }
  return true;
}

TEST(Classify, FollowsEquation5ForEveryChild) {
  for (const Shape kind : {Shape::kSoup, Shape::kTorus, Shape::kGrid, Shape::kSlivers}) {
    for (const LeafPolicy leaf : {LeafPolicy::kSub, LeafPolicy::kGroup}) {
      WideBvh bvh = build(kind, 1500);
      const ClassifyConfig config{0.02, 0.05, leaf};
      const Classification c = classify(bvh, config);
      std::size_t groups = 1, subs = 0;
      for (std::uint32_t i = 0; i < bvh.records.size(); ++i) {
        const BvhRecord& parent = bvh.records[i];
        for (std::uint32_t k = parent.first; !parent.leaf() && k < parent.first + parent.count;
             ++k) {
          const BvhRecord& child = bvh.records[k];
          const bool sub = equation5(child.box, bvh.records[c.group[i]].box, config) ||
                           (child.leaf() && leaf == LeafPolicy::kSub);
          EXPECT_EQ(c.is_group[k], sub ? 0 : 1);
          EXPECT_EQ(c.group[k], sub ? c.group[i] : k);
          ++(sub ? subs : groups);
        }
      }
      EXPECT_EQ(c.group_nodes, groups);
      EXPECT_EQ(c.sub_nodes, subs);
    }
  }
}

TEST(Classify, ZeroThresholdsGiveOneGroup) {
  WideBvh bvh = build(Shape::kTorus, 1000);
  const Classification c = classify(bvh, {0, 0, LeafPolicy::kGroup});
  EXPECT_EQ(c.group_nodes, 1U);
  EXPECT_EQ(c.sub_nodes, bvh.records.size() - 1);
}

TEST(Classify, FullThresholdsMakeEveryInnerNodeAGroup) {
  WideBvh bvh = build(Shape::kSoup, 1000);
  EXPECT_EQ(classify(bvh, {1, 0, LeafPolicy::kSub}).group_nodes, bvh.inner_count());
}

TEST(Classify, FlatAxesOfAGroupCountAsSatisfied) {
  WideBvh bvh = build(Shape::kGrid, 1000);  // z = 0 everywhere
  EXPECT_EQ(classify(bvh, {0, 1e-6, LeafPolicy::kGroup}).group_nodes, 1U);
}

TEST(Classify, GroupsComeFirstAmongSiblingsAndTheTreeStaysTheSame) {
  WideBvh bvh = build(Shape::kSoup, 2000);
  const double cost = sah_cost(bvh);
  const Classification c = classify(bvh, {0.05, 0.1, LeafPolicy::kSub});
  EXPECT_NEAR(sah_cost(bvh), cost, 1e-9 * cost);
  EXPECT_NO_THROW(check_boxes(bvh, "test"));
  for (const BvhRecord& r : bvh.records) {
    for (std::uint32_t k = r.first + 1; !r.leaf() && k < r.first + r.count; ++k) {
      EXPECT_GE(c.is_group[k - 1], c.is_group[k]);
    }
  }
}

TEST(Classify, ATreeOfOneLeafHasNoNodes) {
  WideBvh bvh = build(Shape::kSoup, 1);
  const Classification c = classify(bvh, {});
  EXPECT_EQ(c.group_nodes + c.sub_nodes, 0U);
}

}  // namespace
}  // namespace a2rt::bvh
