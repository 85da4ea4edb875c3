// The brute-force hit, where the rules alone decide.
#include "a2rt/workload/reference.h"

#include <gtest/gtest.h>

namespace a2rt {
namespace {

// One triangle in the plane z = 0 around the origin, in one instance.
Workload one_triangle(const Affine& world_to_object) {
  Workload w;
  Blas blas;
  blas.triangles.push_back({{Vec3{-1, -1, 0}, Vec3{1, -1, 0}, Vec3{0, 1, 0}}});
  blas.geometries.push_back({0, 1, true});
  w.blas.push_back(std::move(blas));
  Instance instance;
  instance.blas = 0;
  instance.world_to_object = world_to_object;
  w.tlas.resize(1);
  w.tlas[0].instances.push_back(instance);
  return w;
}

Ray down() {
  Ray ray;
  ray.origin = {0, 0, 2};
  ray.dir = {0, 0, -1};
  return ray;
}

TEST(Reference, a_ray_through_the_triangle_hits_it) {
  EXPECT_EQ(reference_hit(one_triangle({}), down(), {}).state, HitState::kHit);
}

// Found by fuzzing: the driver's triangle test makes a hit at t = -0 of an infinite direction.
TEST(Reference, an_instance_in_whose_space_the_direction_overflows_is_not_hit) {
  Affine map;
  map.m[2][2] = 0x1p100F;
  Ray ray = down();
  ray.dir.z = -0x1p100F;
  EXPECT_EQ(reference_hit(one_triangle(map), ray, {}).state, HitState::kMiss);
}

TEST(Reference, an_instance_in_whose_space_the_origin_overflows_is_not_hit) {
  Affine map;
  map.m[2][2] = 0x1p100F;
  Ray ray = down();
  ray.origin.z = 0x1p100F;
  EXPECT_EQ(reference_hit(one_triangle(map), ray, {}).state, HitState::kMiss);
}

}  // namespace
}  // namespace a2rt
