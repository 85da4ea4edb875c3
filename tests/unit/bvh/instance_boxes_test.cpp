#include "a2rt/bvh/instance_boxes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "a2rt/arith/oracle.h"
#include "a2rt/workload/driver_triangle.h"
#include "a2rt/workload/synthetic.h"

namespace a2rt::bvh {
namespace {

const Box kObject{{-1, -0.5F, 0}, {2, 0.25F, 0}};  // flat in z

// A world-to-object map: random linear part (mirrored and sheared as it comes), random shift.
Instance random_instance(synthetic::Random& random, float scale) {
  Instance instance;
  instance.blas = 0;
  for (auto& row : instance.world_to_object.m) {
    for (std::size_t j = 0; j < 3; ++j) {
      row[j] = random.between(-1, 1) * scale;
    }
    row[3] = random.between(-100, 100);
  }
  return instance;
}

TEST(InstanceBox, NoRayThatMeetsTheObjectBoxMissesTheWorldBox) {
  synthetic::Random random(5);
  int met = 0;
  for (int i = 0; i < 300; ++i) {
    const Instance instance = random_instance(random, std::exp2(random.between(-8, 8)));
    std::vector<Ray> rays(60);
    const Box rough = instance_world_box(instance, kObject, {});
    if (!rough.valid()) {
      continue;
    }
    for (Ray& ray : rays) {
      // Aimed at the box's corners and edges from up to far away.
      const float far = std::exp2(random.between(0, 20));
      ray.origin = random.in_box(-far, far);
      for (std::size_t a = 0; a < 3; ++a) {
        const float at = random.below(2) == 0 ? rough.lo[a] : rough.hi[a];
        ray.dir[a] = at - ray.origin[a];
      }
    }
    const Box world = instance_world_box(instance, kObject, ray_reach(rays, 0));
    for (const Ray& ray : rays) {
      const Vec3 o = driver_transform_point(instance.world_to_object, ray.origin);
      const Vec3 d = driver_transform_direction(instance.world_to_object, ray.dir);
      if (arith::ray_meets_box(arith::OracleRay(o, d, 0), kObject, 1e30F)) {
        ++met;
        EXPECT_TRUE(arith::ray_meets_box(arith::OracleRay(ray.origin, ray.dir, 0), world, 1e30F));
      }
    }
  }
  EXPECT_GT(met, 500);
}

TEST(InstanceBox, StaysCloseForOrdinaryScenes) {
  Instance instance;
  instance.blas = 0;
  instance.world_to_object.m[0][1] = 0.125F;
  const Box box = instance_world_box(instance, kObject, {{10, 10, 10}, 0.5F});
  for (std::size_t a = 1; a < 3; ++a) {
    EXPECT_NEAR(box.lo[a], kObject.lo[a], 1e-4F);
    EXPECT_NEAR(box.hi[a], kObject.hi[a], 1e-4F);
    EXPECT_LT(box.lo[a], kObject.lo[a]);
  }
}

TEST(InstanceBox, OfAnIdentityIsTheObjectBoxHoweverFarRaysStart) {
  Instance instance;
  instance.blas = 0;
  EXPECT_EQ(instance_world_box(instance, kObject, {{1e30F, 1e30F, 1e30F}, 1e-40F}), kObject);
}

TEST(InstanceBox, RaysThatAreNotTracedAskForNoRoom) {
  std::vector<Ray> rays(4);
  rays[0].origin = {3, 2, 1};
  rays[0].dir = {0.5F, 0, 0};
  for (std::size_t i = 1; i < rays.size(); ++i) {
    rays[i].origin = {1e30F, 0, 0};
    rays[i].dir = {1e-40F, 0, 0};
  }
  rays[1].tmin = 2, rays[1].tmax = 1;
  rays[2].mask = 0x100;  // the driver looks at eight bits
  rays[3].tlas = 1;
  const RayReach reach = ray_reach(rays, 0);
  EXPECT_EQ(reach.origin.x, 3);
  EXPECT_EQ(reach.shortest_direction, 0.5F);
}

// Found by the fuzzer of workloads: extents of all of FP32 cannot be encoded by every unit.
TEST(InstanceBox, WithoutABoundStillHasFiniteExtentsUnlessTheSceneReachesFurther) {
  const Box box = unbounded_box({{1e30F, 0, 0}, 1}, kObject);
  EXPECT_TRUE(std::isfinite(box.hi.x - box.lo.x));
  EXPECT_EQ(unbounded_box({{0, 1e38F, 0}, 1}, kObject).hi.x, std::numeric_limits<float>::max());
}

// Found by a reviewer: boxes ended at 2^100, objects beyond were lost with nothing to show for it.
TEST(InstanceBox, HoldsObjectsAsFarAsFp32Reaches) {
  const Box far{{1e31F, -1e38F, 1}, {2e31F, 3e38F, 2}};
  Instance instance;
  instance.blas = 0;
  EXPECT_EQ(instance_world_box(instance, far, {}), far);
  instance.world_to_object.m[0][0] = 2;
  const Box world = instance_world_box(instance, far, {});
  EXPECT_LE(world.lo.x, 0.5e31F);
  EXPECT_GE(world.hi.x, 1e31F);
  EXPECT_GE(world.hi.y, 3e38F);
}

// Found by the test of special values: rays still have an image under such a map.
TEST(InstanceBox, SingularMapsCanBeHitFromAnywhere) {
  Instance instance;
  instance.blas = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    instance.world_to_object = Affine{};
    instance.world_to_object.m[a][a] = 0;
    EXPECT_EQ(instance_world_box(instance, kObject, {}), unbounded_box({}, kObject));
  }
  instance.world_to_object = Affine{{{0, 0, 0, 1}, {0, 0, 0, 1}, {0, 0, 0, 1}}};
  EXPECT_EQ(instance_world_box(instance, kObject, {}), unbounded_box({}, kObject));
}

TEST(InstanceBox, NonFiniteMapsAndNoStructureCannotBeHit) {
  Instance instance;
  instance.blas = 0;
  instance.world_to_object.m[1][1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(instance_world_box(instance, kObject, {}).valid());
  instance.world_to_object = Affine{};
  instance.blas = kNone;
  EXPECT_FALSE(instance_world_box(instance, kObject, {}).valid());
}

TEST(InstanceBox, ExtremeScalesGiveAFiniteBox) {
  for (const float scale : {1e-37F, 1e37F}) {
    Instance instance;
    instance.blas = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      instance.world_to_object.m[a][a] = scale;
    }
    const Box box = instance_world_box(instance, kObject, {{1, 1, 1}, 1});
    EXPECT_TRUE(box.valid());
    EXPECT_TRUE(std::isfinite(box.hi.x - box.lo.x));
  }
}

}  // namespace
}  // namespace a2rt::bvh
