#include "a2rt/workload/synthetic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "a2rt/workload/driver_layout.h"
#include "a2rt/workload/reference.h"

namespace a2rt::synthetic {
namespace {

std::size_t count(const Workload& w, HitState state) {
  return static_cast<std::size_t>(std::count_if(w.driver_hits.begin(), w.driver_hits.end(),
                                                [&](const Hit& h) { return h.state == state; }));
}

constexpr Shape kAllShapes[] = {Shape::kSoup, Shape::kSphere,  Shape::kTorus,
                                Shape::kGrid, Shape::kSlivers, Shape::kSpheres};

TEST(Synthetic, EveryShapeIsHitAndMissedByItsRays) {
  for (const Shape shape : kAllShapes) {
    Config config;
    config.shape = shape;
    config.primitives = 500;
    const Workload w = make(config);
    EXPECT_GE(w.blas[0].primitive_count(), 500u) << static_cast<int>(shape);
    EXPECT_EQ(w.rays.size(), 32u * 32u * 3u);
    const std::size_t misses = count(w, HitState::kMiss);
    if (shape != Shape::kSlivers) {
      EXPECT_GT(w.rays.size() - misses, 20u) << static_cast<int>(shape);
    }
    EXPECT_GT(misses, 20u) << static_cast<int>(shape);
  }
}

TEST(Synthetic, TheSameSeedGivesTheSameBytesAndAnotherSeedDoesNot) {
  Config config;
  config.instances = 5;
  config.masked_share = 0.5;
  config.primitives = 200;
  config.width = config.height = 12;
  const Workload a = make(config), b = make(config);
  ASSERT_EQ(a.rays.size(), b.rays.size());
  EXPECT_EQ(std::memcmp(a.rays.data(), b.rays.data(), a.rays.size() * sizeof(Ray)), 0);
  EXPECT_EQ(a.driver_hits, b.driver_hits);
  EXPECT_EQ(a.candidates.size(), b.candidates.size());
  config.seed = 2;
  const Workload c = make(config);
  EXPECT_NE(std::memcmp(a.rays.data(), c.rays.data(), a.rays.size() * sizeof(Ray)), 0);
}

TEST(Synthetic, ClosedShapesAreWatertight) {
  for (const Shape shape : {Shape::kSphere, Shape::kTorus}) {
    Config config;
    config.shape = shape;
    config.reference = false;
    Workload w = make(config);
    Random random(7);
    for (int i = 0; i < 200; ++i) {
      Ray ray;
      ray.origin = shape == Shape::kTorus ? Vec3{0.7f, 0.01f, 0.02f} : random.in_box(-0.3f, 0.3f);
      ray.dir = random.direction();
      EXPECT_EQ(reference_hit(w, ray, {}).state, HitState::kHit) << i;
    }
  }
}

TEST(Synthetic, InstanceInversesUndoTheirTransforms) {
  Config config;
  config.instances = 30;
  config.reference = false;
  const Workload w = make(config);
  for (const Instance& i : w.tlas[0].instances) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) {
        float sum = c == 3 ? i.object_to_world.m[r][3] : 0;
        for (int k = 0; k < 3; ++k) {
          sum += i.object_to_world.m[r][k] * i.world_to_object.m[k][c];
        }
        EXPECT_NEAR(sum, r == c ? 1 : 0, 1e-5);
      }
    }
  }
}

TEST(Synthetic, MaskedCandidatesDecideWhatIsHit) {
  Config config;
  config.masked_share = 1;
  config.primitives = 400;
  const Workload w = make(config);
  ASSERT_GT(w.candidates.size(), 100u);
  for (const Hit& hit : w.driver_hits) {
    if (hit.state != HitState::kMiss) {
      EXPECT_EQ(hit.primitive % 2, 0u);  // odd ones are ignored by the any-hit shader
    }
  }
}

TEST(Synthetic, DriverNodesPassTheLayoutGuards) {
  for (const std::uint32_t primitives : {1u, 2u, 3u, 1000u}) {
    for (const Shape shape : {Shape::kSoup, Shape::kSpheres}) {
      Config config;
      config.shape = shape;
      config.primitives = primitives;
      config.instances = primitives == 2 ? 1 : 17;
      config.reference = false;
      config.driver_nodes = true;
      config.width = config.height = 2;
      config.masked_share = 0.3;
      const Workload w = make(config);
      EXPECT_EQ(driver::check_blas(w.blas[0].driver_nodes, w.blas[0]), "");
      EXPECT_EQ(driver::check_tlas(w.tlas[0].driver_nodes, w.tlas[0]), "");
    }
  }
}

}  // namespace
}  // namespace a2rt::synthetic
