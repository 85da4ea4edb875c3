// The audit: decisions against exact arithmetic, misses traced to their mechanism.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "runs.h"

namespace a2rt::rt {
namespace {

using synthetic::Shape;

Audit audit(const std::string& unit, const Workload& w, const std::string& toml = "") {
  FunctionalOptions options;
  options.events = false;
  options.audit_rays = w.rays.size();
  return run_functional(*built(unit, w, toml), w, options).audit;
}

std::uint64_t sum(const Audit& a) {
  return std::accumulate(a.missed_by_mechanism.begin(), a.missed_by_mechanism.end(),
                         std::uint64_t{0}, [](auto s, const auto& m) { return s + m.second; });
}

// Rays along z whose x component is 2^-k: where AQB8's 5-bit shifts end.
Workload near_axis(float small) {
  Workload w = scene(Shape::kSoup, 800);
  synthetic::Random random(3);
  for (Ray& ray : w.rays) {
    ray.origin = {random.between(-0.8F, 0.8F), random.between(-0.8F, 0.8F), -3};
    ray.dir = {small, 0.02F, 1};
    ray.tmax = 10;
    ray.flags = 0;
  }
  return w;
}

TEST(AuditTest, ConservativeUnitsMissNothingOnAnyShape) {
  for (const char* unit : {"a2rt", "cwbvh", "clbvh", "baseline"}) {
    for (const Shape shape : {Shape::kSoup, Shape::kGrid, Shape::kSlivers, Shape::kTorus}) {
      EXPECT_EQ(audit(unit, scene(shape, 600, 3)).missed_hits, 0U) << unit;
    }
    for (const float small : {0.0F, -0.0F, 0x1p-140F, 0x1p-40F, 0x1p-20F}) {
      EXPECT_EQ(audit(unit, near_axis(small)).missed_hits, 0U) << unit << " " << small;
    }
  }
}

TEST(AuditTest, QuantizedBoxesCostSomeRedundantHits) {
  const Workload w = scene(Shape::kSoup, 1500);
  for (const char* unit : {"a2rt", "aqb8", "cwbvh"}) {
    const Audit a = audit(unit, w);
    EXPECT_GT(a.exact_hits, 0U) << unit;
    EXPECT_GT(a.redundant_hits, 0U) << unit;
  }
}

TEST(AuditTest, Aqb8MissesNearAxisAndSaysWhy) {
  struct Expectation {
    float small;
    const char* mechanism;
  };
  for (const Expectation& e : {Expectation{0x1p-20F, "5-bit shift overflows 32 bits (|d| < 2^-16)"},
                               Expectation{0x1p-40F, "5-bit exponent wraps (|d| <= 2^-32)"},
                               Expectation{0.0F, "zero direction component: slope taken as 1"}}) {
    const Audit a = audit("aqb8", near_axis(e.small));
    EXPECT_GT(a.missed_hits, 0U) << e.small;
    EXPECT_EQ(sum(a), a.missed_hits);
    ASSERT_TRUE(a.missed_by_mechanism.contains(e.mechanism)) << e.small;
    EXPECT_GT(a.missed_by_mechanism.at(e.mechanism), a.missed_hits / 2);
  }
}

TEST(AuditTest, LostRaysOfAqb8AreCountedNotRepaired) {
  const Workload w = near_axis(0);
  EXPECT_GT(differences(w, hits_of(*built("aqb8", w), w)), 0U);
  EXPECT_EQ(differences(w, hits_of(*built("a2rt", w), w)), 0U);
}

TEST(AuditTest, NearestRoundingMissesWhatConservativeRoundingKeeps) {
  // Rays through the vertices: they touch the boxes exactly.
  Workload w = scene(Shape::kSoup, 1500);
  for (std::size_t i = 0; i < w.rays.size(); ++i) {
    const Vec3& aim = w.blas[0].triangles[i % w.blas[0].triangles.size()].v[i % 3];
    Ray& ray = w.rays[i];
    ray.origin = {2.5F, 1.5F, -3};
    ray.dir = {aim.x - ray.origin.x, aim.y - ray.origin.y, aim.z - ray.origin.z};
    ray.tmin = 0;
    ray.tmax = 100;
    ray.flags = 0;
  }
  EXPECT_EQ(audit("a2rt", w).missed_hits, 0U);
  EXPECT_GT(audit("a2rt", w, "[precision]\nrounding = 'nearest'").missed_hits, 0U);
}

TEST(AuditTest, GuardedOriginsEscapeAndStillMissNothing) {
  Workload w = scene(Shape::kSoup, 800);
  for (Ray& ray : w.rays) {
    for (std::size_t a = 0; a < 3; ++a) {
      ray.origin[a] -= 3e6F * ray.dir[a];
    }
    ray.tmax = 1e7F;
  }
  const Audit a = audit("a2rt", w, "[precision]\norigin = 'guard'");
  EXPECT_GT(a.escapes, 0U);
  EXPECT_EQ(a.missed_hits, 0U);
  EXPECT_EQ(a.decided, a.qbox_tests + a.escapes);
}

// Slots of the public code's window are tested, but no box of the node stands behind them.
TEST(AuditTest, SlotsBeyondANodesChildrenAreTestedButNotDecided) {
  const Workload w = scene(Shape::kSoup, 800);
  const Audit own = audit("aqb8", w), window = audit("aqb8", w, "artifact = true");
  EXPECT_GE(own.decided, own.qbox_tests);  // and anchors
  EXPECT_LT(window.decided, window.qbox_tests);
}

}  // namespace
}  // namespace a2rt::rt
