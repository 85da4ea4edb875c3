#include "rebuild/bvh_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace a2rt::layer {
namespace {

constexpr std::uint32_t kNodes = sizeof(DriverHeader);

struct Built {
  std::vector<DriverBoxNode> nodes;
  std::uint32_t leaves_offset = 0;
};

Built build(std::vector<BuildItem> items, std::uint32_t limit, unsigned threads) {
  Built out;
  out.nodes.resize(items.size() - 1);
  out.leaves_offset = kNodes + static_cast<std::uint32_t>(out.nodes.size() * sizeof(DriverBoxNode));
  build_sah(items, {out.nodes.data(), kNodes, out.leaves_offset, 48, 0}, limit, threads);
  return out;
}

std::vector<BuildItem> random_items(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-10, 10);
  std::vector<BuildItem> items;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float x = place(random), y = place(random), z = place(random) * 0.1f;
    items.push_back({{{x, y, z}, {x + 0.1f, y + 0.2f, z}}, i});
  }
  return items;
}

struct Measure {
  std::uint32_t depth = 0;
  double cost = 0;
  std::vector<int> seen;
};

double area(const DriverBox& b) {
  const double x = double{b.hi[0]} - b.lo[0], y = double{b.hi[1]} - b.lo[1];
  const double z = double{b.hi[2]} - b.lo[2];
  return x * y + y * z + z * x;
}

// Walks the tree, checks that every box holds its leaves, adds up the areas.
DriverBox walk(const Built& tree, const std::vector<BuildItem>& items, std::uint32_t node,
               std::uint32_t depth, Measure& measure) {
  measure.depth = std::max(measure.depth, depth);
  const DriverBoxNode& n = tree.nodes[node];
  DriverBox all = n.bounds[0];
  for (std::size_t i = 0; i < 2; ++i) {
    DriverBox inside;
    if ((n.children[i] & 3u) == kBoxNodeType) {
      inside = walk(tree, items, ((n.children[i] & ~3u) - kNodes) / 56, depth + 1, measure);
    } else {
      const std::uint32_t leaf = ((n.children[i] & ~3u) - tree.leaves_offset) / 48;
      ++measure.seen[leaf];
      inside = items[leaf].box;
    }
    EXPECT_EQ(std::memcmp(&inside, &n.bounds[i], sizeof(inside)), 0);
    measure.cost += area(n.bounds[i]);
    for (int a = 0; a < 3; ++a) {
      all.lo[a] = std::min(all.lo[a], n.bounds[i].lo[a]);
      all.hi[a] = std::max(all.hi[a], n.bounds[i].hi[a]);
    }
  }
  return all;
}

Measure measure(const Built& tree, const std::vector<BuildItem>& items) {
  Measure out;
  out.seen.resize(items.size());
  walk(tree, items, 0, 1, out);
  EXPECT_EQ(std::count(out.seen.begin(), out.seen.end(), 1),
            static_cast<std::ptrdiff_t>(items.size()));
  return out;
}

TEST(BuildSah, every_leaf_is_reached_once_in_tight_boxes) {
  for (const std::size_t count : {2u, 3u, 4u, 5u, 17u, 100u, 20000u}) {
    const auto items = random_items(count, 7);
    measure(build(items, 30, 2), items);
  }
}

TEST(BuildSah, threads_do_not_change_a_byte) {
  const auto items = random_items(50000, 3);
  const Built one = build(items, 30, 1);
  for (const unsigned threads : {2u, 3u, 8u}) {
    const Built more = build(items, 30, threads);
    EXPECT_EQ(std::memcmp(one.nodes.data(), more.nodes.data(), one.nodes.size() * 56), 0);
  }
}

TEST(BuildSah, keeps_to_the_depth_limit_even_where_the_heuristic_would_peel) {
  // Boxes in a geometric series: each best split takes one box away.
  std::vector<BuildItem> items;
  float at = 1;
  for (std::uint32_t i = 0; i < 100; ++i, at *= 1.7f) {
    items.push_back({{{at, 0, 0}, {at * 1.1f, 1, 1}}, i});
  }
  EXPECT_EQ(measure(build(items, 7, 2), items).depth, 7u);
  EXPECT_LE(measure(build(items, 12, 2), items).depth, 12u);
}

TEST(BuildSah, equal_and_infinite_boxes_are_built_too) {
  std::vector<BuildItem> items;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (std::uint32_t i = 0; i < 70; ++i) {
    items.push_back({{{0, 0, 0}, {1, 1, 1}}, i});
  }
  items.push_back({{{-kInfinity, 0, 0}, {kInfinity, 1, 1}}, 70});
  items.push_back({{{0, 0, 0}, {kInfinity, 1, kInfinity}}, 71});
  measure(build(items, 30, 2), items);
}

TEST(BuildSah, is_far_better_than_halving_in_index_order) {
  const auto items = random_items(4096, 11);
  const double sah = measure(build(items, 30, 2), items).cost;
  // What the driver does: halves of the index order.
  const auto halved = [&](const auto& self, std::size_t a, std::size_t b) -> double {
    if (b - a == 1) {
      return 0;
    }
    double cost = 0;
    const std::size_t middle = (a + b) / 2;
    for (const auto& [lo, hi] : {std::pair{a, middle}, std::pair{middle, b}}) {
      DriverBox box = items[lo].box;
      for (std::size_t i = lo; i < hi; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
          box.lo[axis] = std::min(box.lo[axis], items[i].box.lo[axis]);
          box.hi[axis] = std::max(box.hi[axis], items[i].box.hi[axis]);
        }
      }
      cost += area(box) + self(self, lo, hi);
    }
    return cost;
  };
  EXPECT_LT(sah * 20, halved(halved, 0, items.size()));
}

}  // namespace
}  // namespace a2rt::layer
