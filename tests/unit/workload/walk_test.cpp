#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "a2rt/workload/check.h"
#include "a2rt/workload/driver_layout.h"
#include "a2rt/workload/driver_triangle.h"
#include "a2rt/workload/exact_walk.h"
#include "a2rt/workload/ray_rules.h"
#include "a2rt/workload/reference.h"
#include "a2rt/workload/synthetic.h"

namespace a2rt {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr float kInf = std::numeric_limits<float>::infinity();

// A square of side 2 around the z axis at z = height, seen from z < height as front or back.
void add_square(Blas& blas, float height, bool opaque) {
  const Vec3 a{-1, -1, height}, b{1, -1, height}, c{1, 1, height}, d{-1, 1, height};
  const std::uint32_t first = blas.primitive_count();
  blas.triangles.push_back({{a, b, c}});
  blas.triangles.push_back({{a, c, d}});
  blas.geometries.push_back({first, 2, opaque});
}

Workload finish(Blas blas, std::vector<Instance> instances = {Instance{}}) {
  Workload w;
  blas.driver_nodes = driver::build_blas(blas);
  w.blas.push_back(std::move(blas));
  for (Instance& i : instances) {
    i.blas = 0;
  }
  w.tlas.push_back({std::move(instances), {}});
  w.tlas[0].driver_nodes = driver::build_tlas(w.tlas[0], w.blas);
  return w;
}

// Along +z from the origin, through the first triangle of every square.
Ray upward(std::uint32_t flags = 0) {
  Ray ray;
  ray.origin = {0.5f, 0.25f, 0};
  ray.dir = {0, 0, 1};
  ray.flags = flags;
  return ray;
}

Workload two_squares(bool first_opaque = true) {
  Blas blas;
  add_square(blas, 1, first_opaque);
  add_square(blas, 2, true);
  return finish(std::move(blas));
}

Hit walk(const Workload& w, const Ray& ray, std::vector<Candidate> candidates = {}) {
  const ExactWalk exact(w);
  EXPECT_EQ(exact.problem(0), "");
  return exact.walk(ray, candidates).hit;
}

std::uint32_t geometry_hit(const Workload& w, std::uint32_t flags) {
  return walk(w, upward(flags)).geometry;
}

TEST(ExactWalk, AgreesWithBruteForceOnEveryShape) {
  using synthetic::Shape;
  for (const Shape shape : {Shape::kSoup, Shape::kSphere, Shape::kTorus, Shape::kGrid,
                            Shape::kSlivers, Shape::kSpheres}) {
    for (const std::uint32_t instances : {1u, 9u}) {
      synthetic::Config config;
      config.shape = shape;
      config.primitives = 300;
      config.instances = instances;
      config.width = config.height = 16;
      config.driver_nodes = true;
      const Workload w = synthetic::make(config);
      const ExactWalk exact(w);
      std::size_t differences = 0;
      for (std::size_t i = 0; i < w.rays.size(); ++i) {
        Ray ray = w.rays[i];
        ray.flags = 0;
        // Reports in the order of leaves are not known here, so only those of the hit are given.
        std::vector<Candidate> nearest;
        for (const Candidate& c : candidates_of(w, i)) {
          if (c.is_report != 0 && c.primitive == w.driver_hits[i].primitive &&
              c.instance == w.driver_hits[i].instance) {
            nearest.push_back(c);
          }
        }
        const Hit found = exact.walk(ray, nearest).hit;
        const Hit& expected = w.driver_hits[i];
        const bool same = (found.state == HitState::kMiss) == (expected.state == HitState::kMiss) &&
                          (found.state == HitState::kMiss || found.t == expected.t);
        differences += same ? 0 : 1;
      }
      // The driver's boxes are not padded: a flat or thin triangle can hide behind its own box.
      EXPECT_LE(differences, w.rays.size() / 50) << static_cast<int>(shape) << " " << instances;
    }
  }
}

TEST(ExactWalk, IntervalsAreOpenAtBothEnds) {
  const Workload w = two_squares();
  Ray ray = upward();
  EXPECT_EQ(walk(w, ray).t, 1);
  ray.tmin = 1;
  EXPECT_EQ(walk(w, ray).t, 2);
  ray.tmin = std::nextafter(1.0f, 0.0f);
  EXPECT_EQ(walk(w, ray).t, 1);
  ray.tmin = 0;
  ray.tmax = 1;
  EXPECT_EQ(walk(w, ray).state, HitState::kMiss);
  ray.tmax = std::nextafter(1.0f, 2.0f);
  EXPECT_EQ(walk(w, ray).t, 1);
}

TEST(ExactWalk, FacingIsCulledAfterTheInstancesFlip) {
  Workload w = two_squares();
  const Hit hit = walk(w, upward());
  const bool front = hit.kind == kHitKindFront;
  const std::uint32_t cull = front ? kRayCullFrontFacing : kRayCullBackFacing;
  const std::uint32_t other = front ? kRayCullBackFacing : kRayCullFrontFacing;
  EXPECT_EQ(geometry_hit(w, cull), kNone);
  EXPECT_EQ(geometry_hit(w, other), 0u);
  Blas blas = w.blas[0];
  Instance flipped;
  flipped.flags = kInstanceFlipFacing;
  w = finish(blas, {flipped});
  EXPECT_EQ(geometry_hit(w, cull), 0u);
  EXPECT_EQ(geometry_hit(w, other), kNone);
  EXPECT_EQ(walk(w, upward()).kind, front ? kHitKindBack : kHitKindFront);
  Instance uncullable;
  uncullable.flags = kInstanceCullDisable;
  w = finish(blas, {uncullable});
  EXPECT_EQ(geometry_hit(w, cull | other), 0u);
}

TEST(ExactWalk, OpacityIsDecidedByGeometryThenInstanceThenRay) {
  const Workload w = two_squares(false);
  EXPECT_EQ(geometry_hit(w, kRayCullNoOpaque), 1u);
  EXPECT_EQ(geometry_hit(w, kRayCullOpaque), 0u);
  EXPECT_EQ(geometry_hit(w, kRayOpaque | kRayCullNoOpaque), 0u);
  EXPECT_EQ(geometry_hit(w, kRayOpaque | kRayNoOpaque | kRayCullNoOpaque), kNone);
  Instance opaque, transparent;
  opaque.flags = kInstanceForceOpaque;
  transparent.flags = kInstanceForceNoOpaque;
  EXPECT_EQ(geometry_hit(finish(w.blas[0], {opaque}), kRayCullNoOpaque), 0u);
  EXPECT_EQ(geometry_hit(finish(w.blas[0], {transparent}), kRayCullNoOpaque), kNone);
  EXPECT_EQ(geometry_hit(w, kRaySkipTriangles), kNone);
}

TEST(ExactWalk, MasksChooseInstances) {
  Blas blas;
  add_square(blas, 1, true);
  Instance near, far;
  near.mask = 0x0f;
  far.mask = 0xf0;
  far.object_to_world.m[2][3] = 3;
  far.world_to_object.m[2][3] = -3;
  const Workload w = finish(std::move(blas), {near, far});
  Ray ray = upward();
  EXPECT_EQ(walk(w, ray).instance, 0u);
  ray.mask = 0x10;
  EXPECT_EQ(walk(w, ray).instance, 1u);
  EXPECT_EQ(walk(w, ray).t, 4);
  ray.mask = 0;
  EXPECT_EQ(walk(w, ray).state, HitState::kMiss);
}

TEST(ExactWalk, AnyHitVerdictsDecide) {
  const Workload w = two_squares(false);
  Candidate c{0, 0, 0, 1, kHitKindFront, 0, 0};
  EXPECT_EQ(walk(w, upward(), {c}).geometry, 0u);
  c.verdict = static_cast<std::uint32_t>(1);
  EXPECT_EQ(walk(w, upward(), {c}).geometry, 1u);
  EXPECT_EQ(walk(w, upward()).geometry, 0u) << "no any-hit shader: accepted";
  EXPECT_EQ(walk(w, upward(kRayQuery)).geometry, 1u) << "a query confirms what it wants";
  c.t = 1.5f;  // of another candidate
  const ExactWalk exact(w);
  EXPECT_EQ(exact.walk(upward(), std::span(&c, 1)).unused_verdicts, 1u);
}

TEST(ExactWalk, FirstHitRaysAndTerminatingVerdictsStop) {
  const Workload w = two_squares(false);
  const ExactWalk exact(w);
  const std::uint32_t all = exact.walk(upward(), {}).triangle_tests;
  EXPECT_LE(exact.walk(upward(kRayTerminateOnFirstHit), {}).triangle_tests, all);
  const Candidate c{0, 0, 0, 1, kHitKindFront, 2, 0};
  const WalkResult stopped = exact.walk(upward(), std::span(&c, 1), true);
  EXPECT_EQ(stopped.hit.geometry, 0u);
  ASSERT_EQ(stopped.met.size(), 1u);
  EXPECT_EQ(stopped.met[0].verdict, 2u);
}

TEST(ExactWalk, ReportsCountOnClosedIntervals) {
  Blas blas;
  blas.aabbs.push_back({{-1, -1, 1}, {1, 1, 2}});
  blas.aabbs.push_back({{-1, -1, 3}, {1, 1, 4}});
  blas.geometries.push_back({0, 2, true});
  const Workload w = finish(std::move(blas));
  Candidate report{0, 0, 0, 1.5f, 7, 1, 1};
  Ray ray = upward();
  EXPECT_EQ(walk(w, ray, {report}).kind, 7u);
  ray.tmin = 1.5f;
  EXPECT_EQ(walk(w, ray, {report}).t, 1.5f);
  ray.tmin = 0;
  ray.tmax = 1.5f;
  EXPECT_EQ(walk(w, ray, {report}).t, 1.5f);
  ray.tmax = 1.25f;
  const ExactWalk exact(w);
  EXPECT_EQ(exact.walk(ray, std::span(&report, 1)).disagreements, 1u);
  EXPECT_EQ(geometry_hit(w, kRaySkipAabbs), kNone);
}

TEST(ExactWalk, AnEmptyStructureIsMissed) {
  Workload w;
  w.tlas.emplace_back();
  EXPECT_EQ(walk(w, upward()).state, HitState::kMiss);
}

TEST(LayoutGuards, EveryDifferenceIsNamed) {
  const Workload w = two_squares();
  const auto problem_after = [&](std::size_t at, std::uint32_t value) {
    std::vector<std::byte> nodes = w.blas[0].driver_nodes;
    std::memcpy(nodes.data() + at, &value, sizeof value);
    return driver::check_blas(nodes, w.blas[0]);
  };
  const std::size_t leaves = 40 + 3 * 56;
  EXPECT_EQ(driver::check_blas(w.blas[0].driver_nodes, w.blas[0]), "");
  EXPECT_THAT(problem_after(offsetof(driver::Header, leaf_offset), 44), HasSubstr("leaves start"));
  EXPECT_EQ(problem_after(40 + 48, driver::kRoot), "node at byte 40 is referred to twice");
  EXPECT_EQ(problem_after(40 + 48, 4000u | 1u), "node at byte 4000 is no node");
  EXPECT_EQ(problem_after(40 + 48, 44u | 1u), "node at byte 44 is no node");
  EXPECT_THAT(problem_after(40 + 48, (leaves & ~3u) | 3u), HasSubstr("leaf of the wrong type"));
  EXPECT_THAT(problem_after(40 + 48, driver::kInvalidNode), HasSubstr("no box node leads to it"));
  EXPECT_THAT(problem_after(leaves, 0x12345678u), HasSubstr("leaf 0: coordinates differ"));
  EXPECT_THAT(problem_after(leaves + 40, 9), HasSubstr("leaf 0: primitive or geometry index"));
  EXPECT_THAT(problem_after(leaves + 44, 0), HasSubstr("leaf 0: opaque flag"));
  const std::span<const std::byte> whole(w.blas[0].driver_nodes);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_THAT(driver::check_blas(whole.first(length), w.blas[0]), HasSubstr(" bytes, expected "));
  }
}

TEST(LayoutGuards, InstancesWithoutStructureHaveNoLeaf) {
  Blas blas;
  add_square(blas, 1, true);
  std::vector<Instance> instances(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    instances[i].object_to_world.m[2][3] = static_cast<float>(i);
    instances[i].world_to_object.m[2][3] = -static_cast<float>(i);
  }
  Workload w = finish(std::move(blas), instances);
  // As the driver does it: instance 0 is inactive, the others move up, the tree has two leaves.
  w.tlas[0].instances[0].blas = kNone;
  std::vector<std::byte>& nodes = w.tlas[0].driver_nodes;
  const std::size_t leaves = 40 + 2 * 56, size = sizeof(driver::InstanceLeaf);
  std::memmove(nodes.data() + leaves, nodes.data() + leaves + size, 2 * size);
  std::memset(nodes.data() + leaves + 2 * size, 0, size);
  driver::BoxNode root{};
  std::memcpy(static_cast<void*>(&root), nodes.data() + 40, sizeof root);
  root.bounds[0] = root.bounds[1] = {{-2, -2, 0}, {2, 2, 9}};
  root.children[0] = static_cast<std::uint32_t>(leaves) | 2u;
  root.children[1] = static_cast<std::uint32_t>(leaves + size) | 2u;
  std::memcpy(nodes.data() + 40, static_cast<const void*>(&root), sizeof root);
  EXPECT_EQ(driver::check_tlas(nodes, w.tlas[0]), "");
  EXPECT_EQ(walk(w, upward()).instance, 1u);
  EXPECT_EQ(walk(w, upward()).t, 2);
  root.children[1] = static_cast<std::uint32_t>(leaves + 2 * size) | 2u;
  std::memcpy(nodes.data() + 40, static_cast<const void*>(&root), sizeof root);
  EXPECT_EQ(driver::check_tlas(nodes, w.tlas[0]), "leaf 1: no box node leads to it");
  w.tlas[0].instances[0].blas = 0;
  EXPECT_EQ(driver::check_tlas(nodes, w.tlas[0]), "leaf 0: holds another instance");
}

TEST(Check, ADifferenceIsCountedAndShown) {
  synthetic::Config config;
  config.width = config.height = 16;
  config.driver_nodes = true;
  config.reference = false;
  Workload w = synthetic::make(config);
  const ExactWalk exact(w);
  for (std::size_t i = 0; i < w.rays.size(); ++i) {
    w.driver_hits[i] = exact.walk(w.rays[i], {}).hit;
  }
  EXPECT_TRUE(check_workload(w).passed());
  std::size_t hit = 0;
  while (w.driver_hits[hit].state != HitState::kHit) {
    ++hit;
  }
  w.driver_hits[hit].t = std::nextafter(w.driver_hits[hit].t, kInf);
  const CheckReport report =
      check_workload(w, {.threads = 2, .keep_differences = 4, .progress = {}});
  EXPECT_EQ(report.different, 1u);
  EXPECT_FALSE(report.passed());
  ASSERT_EQ(report.differences.size(), 1u);
  EXPECT_EQ(report.differences[0].ray, hit);
  EXPECT_EQ(report.differences[0].reason, "another distance");
  EXPECT_EQ(report.equal, w.rays.size() - 1);
}

TEST(Check, MissingNodesAreNotPassedOver) {
  synthetic::Config config;
  config.width = config.height = 2;
  Workload w = synthetic::make(config);
  const CheckReport report = check_workload(w);
  EXPECT_EQ(report.unwalkable, w.rays.size());
  EXPECT_FALSE(report.passed());
  ASSERT_EQ(report.problems.size(), 1u);
  EXPECT_THAT(report.problems[0], StartsWith("tlas 0: the driver's nodes were not captured"));
}

TEST(DriverTriangle, MatchesExactGeometryAwayFromEdges) {
  synthetic::Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const Triangle t{{random.in_box(-1, 1), random.in_box(-1, 1), random.in_box(-1, 1)}};
    const Vec3 origin = random.in_box(-2, 2);
    const float u = random.between(0.1f, 0.4f), v = random.between(0.1f, 0.4f);
    Vec3 target;
    for (std::size_t a = 0; a < 3; ++a) {
      target[a] = t.v[0][a] * (1 - u - v) + t.v[1][a] * u + t.v[2][a] * v;
    }
    const Vec3 dir{target.x - origin.x, target.y - origin.y, target.z - origin.z};
    const DriverTriangleHit hit = DriverTriangleTest(origin, dir)(t);
    ASSERT_TRUE(hit.hit) << i;
    EXPECT_NEAR(hit.t, 1, 2e-3) << i;
  }
}

TEST(DriverTriangle, SharedEdgesDoNotLeak) {
  // Two triangles on both sides of an edge, seen from above, by rays aimed at the edge.
  synthetic::Random random(5);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 a{random.between(-2, -1), random.between(-0.1f, 0.1f), random.between(-1, 1)};
    const Vec3 b{random.between(1, 2), random.between(-0.1f, 0.1f), random.between(-1, 1)};
    const Triangle left{{a, b, {random.between(-1, 1), 9, random.between(-1, 1)}}};
    const Triangle right{{b, a, {random.between(-1, 1), -9, random.between(-1, 1)}}};
    const Vec3 origin{random.between(-1, 1), random.between(-0.5f, 0.5f), random.between(5, 9)};
    const float s = random.between(0.01f, 0.99f);
    Vec3 dir;
    for (std::size_t k = 0; k < 3; ++k) {
      dir[k] = a[k] * (1 - s) + b[k] * s - origin[k];
    }
    const DriverTriangleTest test(origin, dir);
    EXPECT_TRUE(test(left).hit || test(right).hit) << i;
  }
}

}  // namespace
}  // namespace a2rt
