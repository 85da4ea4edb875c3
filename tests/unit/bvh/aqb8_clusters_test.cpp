#include "a2rt/bvh/aqb8_clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "a2rt/arith/aqb8_arith.h"
#include "a2rt/base/error.h"
#include "shapes.h"

namespace a2rt::bvh {
namespace {

using synthetic::Shape;

// Cost of one full assignment of switches: the recurrence without any table.
double cost_of(const WideBvh& bvh, const ClusterConfig& k, const std::vector<bool>& switches,
               std::uint32_t v, std::uint32_t anchor) {
  const BvhRecord& r = bvh.records[v];
  const double a = quantized_half_area(r.box, bvh.records[anchor].box);
  if (r.leaf()) {
    return k.t_ist * (k.leaf_count ? r.count : 1) * a;
  }
  double cost = (2 * k.t_trv_int + (switches[v] ? k.t_switch : 0)) * a;
  for (std::uint32_t c = r.first; c < r.first + r.count; ++c) {
    cost += cost_of(bvh, k, switches, c, switches[v] ? v : anchor);
  }
  return cost;
}

double cheapest_by_trying_all(const WideBvh& bvh, const ClusterConfig& config) {
  std::vector<std::uint32_t> inner;
  for (std::uint32_t i = 1; i < bvh.records.size(); ++i) {
    if (!bvh.records[i].leaf()) {
      inner.push_back(i);
    }
  }
  EXPECT_LE(inner.size(), 14U);
  double best = std::numeric_limits<double>::infinity();
  for (std::uint32_t choice = 0; choice < 1U << inner.size(); ++choice) {
    std::vector<bool> switches(bvh.records.size(), false);
    switches[0] = true;
    for (std::size_t i = 0; i < inner.size(); ++i) {
      switches[inner[i]] = (choice >> i & 1U) != 0;
    }
    best = std::min(best, cost_of(bvh, config, switches, 0, 0));
  }
  return best;
}

TEST(Aqb8Clusters, DynamicProgramFindsTheCheapestOfAllAssignments) {
  for (const double t_switch : {0.0, 0.1, 0.8, 1.0}) {
    for (const bool count : {false, true}) {
      ClusterConfig config;
      config.t_switch = t_switch;
      config.leaf_count = count;
      for (const std::uint32_t n : {14U, 20U, 26U}) {
        const WideBvh bvh = build(Shape::kSoup, n, {4, 2});
        const double best = cheapest_by_trying_all(bvh, config);
        EXPECT_NEAR(cluster_aqb8(bvh, config).cost, best, 1e-9 * best);
      }
    }
  }
}

TEST(Aqb8Clusters, EmittedSwitchesCostWhatTheProgramClaims) {
  const WideBvh bvh = build(Shape::kTorus, 3000);
  const ClusterConfig config;
  const Clustering c = cluster_aqb8(bvh, config);
  const std::vector<bool> switches(c.is_switch.begin(), c.is_switch.end());
  EXPECT_NEAR(cost_of(bvh, config, switches, 0, 0), c.cost, 1e-9 * c.cost);
  EXPECT_GT(c.clusters.size(), 1U);
}

TEST(Aqb8Clusters, EveryNodeAndPrimitiveHasOnePlaceInItsCluster) {
  const WideBvh bvh = build(Shape::kSoup, 2000);
  const Clustering c = cluster_aqb8(bvh, {});
  ASSERT_EQ(c.order.size(), bvh.records.size() - 1);
  ASSERT_EQ(c.primitives.size(), bvh.order.size());
  std::uint32_t nodes = 0, triangles = 0;
  for (const Cluster& k : c.clusters) {
    EXPECT_EQ(k.node_offset, nodes);
    EXPECT_EQ(k.triangle_offset, triangles);
    nodes += k.node_count;
    triangles += k.triangle_count;
  }
  for (const BvhRecord& r : bvh.records) {
    for (std::uint32_t k = 1; !r.leaf() && k < r.count; ++k) {
      EXPECT_EQ(c.position[r.first + k], c.position[r.first] + k);  // siblings adjacent
    }
  }
  std::vector<std::uint32_t> sorted = c.primitives;
  std::sort(sorted.begin(), sorted.end());
  for (std::uint32_t i = 0; i < sorted.size(); ++i) {
    EXPECT_EQ(sorted[i], i);
  }
}

TEST(Aqb8Clusters, AFullClusterIsSplitSoThatAddressesFit) {
  const WideBvh bvh = build(Shape::kSoup, 3000);
  ClusterConfig config;
  config.t_switch = 1e6;  // never worth it: one cluster
  EXPECT_EQ(cluster_aqb8(bvh, config).clusters.size(), 1U);
  config.capacity = 200;
  const Clustering c = cluster_aqb8(bvh, config);
  EXPECT_GT(c.capacity_splits, 0U);
  for (const Cluster& k : c.clusters) {
    EXPECT_LE(k.node_count, 200U);
    EXPECT_LE(k.triangle_count, 200U);
  }
}

TEST(Aqb8Clusters, TooManyClustersIsAnErrorWithTheRemedy) {
  ClusterConfig config;
  config.t_switch = 0;
  config.most_clusters = 3;
  try {
    (void)cluster_aqb8(build(Shape::kSoup, 3000), config);
    FAIL() << "accepted";
  } catch (const UserError& e) {
    EXPECT_NE(std::string(e.what()).find("t_switch"), std::string::npos);
  }
}

TEST(Aqb8Clusters, AreaIsThatOfTheArithmetic) {
  const WideBvh bvh = build(Shape::kTorus, 400);
  const arith::Aqb8Anchor anchor = arith::make_aqb8_anchor(bvh.records[0].box);
  for (const BvhRecord& r : bvh.records) {
    const double mine = quantized_half_area(r.box, bvh.records[0].box);
    const double theirs =
        static_cast<double>(arith::aqb8_half_area(arith::quantize_aqb8(r.box, anchor), anchor));
    EXPECT_NEAR(mine, theirs, 1e-5 * theirs + 1e-12);
  }
}

TEST(Aqb8Clusters, AdoptedOrderMakesLeavesContiguousByCluster) {
  WideBvh bvh = build(Shape::kSoup, 500);
  const std::vector<std::uint32_t> before = bvh.order;
  Clustering c = cluster_aqb8(bvh, {});
  const Clustering copy = c;
  adopt_cluster_order(bvh, c);
  for (std::uint32_t i = 0; i < bvh.order.size(); ++i) {
    EXPECT_EQ(bvh.order[i], before[copy.primitives[i]]);
    EXPECT_EQ(c.primitives[i], i);
  }
}

}  // namespace
}  // namespace a2rt::bvh
