// The brute-force hit, where the rules alone decide.
#include "a2rt/workload/reference.h"

#include <gtest/gtest.h>

namespace a2rt {
namespace {

Workload one_triangle(const Triangle& triangle, const Affine& world_to_object) {
  Workload w;
  Blas blas;
  blas.triangles.push_back(triangle);
  blas.geometries.push_back({0, 1, true});
  w.blas.push_back(std::move(blas));
  Instance instance;
  instance.blas = 0;
  instance.world_to_object = world_to_object;
  w.tlas.resize(1);
  w.tlas[0].instances.push_back(instance);
  return w;
}

TEST(Reference, a_ray_through_the_triangle_hits_it) {
  const Triangle triangle{{Vec3{-1, -1, 0}, Vec3{1, -1, 0}, Vec3{0, 1, 0}}};
  Ray ray;
  ray.origin = {0, 0, 2};
  ray.dir = {0, 0, -1};
  EXPECT_EQ(reference_hit(one_triangle(triangle, {}), ray, {}).state, HitState::kHit);
}

// Found by fuzzing: the driver's triangle test makes a hit at t = -0 of an infinite direction.
TEST(Reference, an_instance_in_whose_space_the_direction_overflows_is_not_hit) {
  const Triangle triangle{{Vec3{-0x1.00018cp+94F, 0x1.ec013p-100F, -0x1.0001fcp-86F},
                           Vec3{0x1.0001c6p+78F, 0x1.0001bep+4F, -0x1.0001a8p+67F},
                           Vec3{-0x1.000164p-42F, 0x1.000212p+86F, 0x1.00017cp-55F}}};
  Affine map;
  map.m[2][2] = 0x1p60F;
  Ray ray;
  ray.origin = {0x1.7fp-126F, 0x1.0001bap+24F, 0x1.00015cp+59F};
  ray.dir = {-0x1.9cb03p-86F, 0x1.d6032cp+30F, 0x1p70F};
  ray.tmin = -0x1.ap-123F;
  ray.tmax = 0x1.3p-56F;
  EXPECT_EQ(reference_hit(one_triangle(triangle, map), ray, {}).state, HitState::kMiss);
}

}  // namespace
}  // namespace a2rt
