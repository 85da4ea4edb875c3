// Vulkan's candidate rules, on scenes small enough to work out by hand.
#include <gtest/gtest.h>

#include "runs.h"

namespace a2rt::rt {
namespace {

// Two parallel unit squares (two triangles each), z = 1 and z = 2; geometry 0 and 1.
Workload two_walls() {
  Workload w;
  Blas blas;
  for (const float z : {1.0F, 2.0F}) {
    blas.triangles.push_back({{{-1, -1, z}, {1, -1, z}, {1, 1, z}}});
    blas.triangles.push_back({{{-1, -1, z}, {1, 1, z}, {-1, 1, z}}});
  }
  blas.geometries = {{0, 2, true}, {2, 2, true}};
  w.blas.push_back(blas);
  w.tlas.resize(1);
  w.tlas[0].instances.resize(1);
  w.tlas[0].instances[0].blas = 0;
  Ray ray;
  ray.origin = {0.25F, -0.25F, 0};
  ray.dir = {0, 0, 1};
  w.rays.push_back(ray);
  w.candidate_first.assign(2, 0);
  w.driver_hits.resize(1);
  return w;
}

Candidate judged(std::uint32_t geometry, std::uint32_t verdict) {
  Candidate c;
  c.instance = 0;
  c.geometry = geometry;
  c.primitive = 0;
  c.verdict = verdict;
  return c;
}

class Rules : public testing::TestWithParam<const char*> {
 protected:
  Hit trace(const Workload& w, const std::vector<Candidate>& candidates = {}) {
    return built(GetParam(), w)->trace({&w.rays[0], candidates});
  }
};

TEST_P(Rules, TheNearestWallIsHit) {
  const Hit hit = trace(two_walls());
  EXPECT_EQ(hit.state, HitState::kHit);
  EXPECT_EQ(hit.t, 1);
  EXPECT_EQ(hit.geometry, 0U);
}

TEST_P(Rules, TheIntervalIsOpenAtBothEnds) {
  Workload w = two_walls();
  w.rays[0].tmin = 1;
  EXPECT_EQ(trace(w).t, 2);
  w.rays[0].tmax = 2;
  EXPECT_EQ(trace(w).state, HitState::kMiss);
}

TEST_P(Rules, MasksMustOverlap) {
  Workload w = two_walls();
  w.tlas[0].instances[0].mask = 0x0f;
  w.rays[0].mask = 0xf0;
  EXPECT_EQ(trace(w).state, HitState::kMiss);
  w.rays[0].mask = 0x18;
  EXPECT_EQ(trace(w).state, HitState::kHit);
}

TEST_P(Rules, FacingIsCulledUnlessTheInstanceForbidsIt) {
  Workload w = two_walls();
  const bool front = trace(w).kind == 0xFE;
  w.rays[0].flags = front ? kRayCullFrontFacing : kRayCullBackFacing;
  EXPECT_EQ(trace(w).state, HitState::kMiss);
  w.tlas[0].instances[0].flags = kInstanceCullDisable;
  EXPECT_EQ(trace(w).state, HitState::kHit);
  w.tlas[0].instances[0].flags = kInstanceFlipFacing;
  const Hit flipped = trace(w);
  EXPECT_EQ(flipped.state, HitState::kHit);
  EXPECT_EQ(flipped.kind, front ? 0xFFU : 0xFEU);
}

TEST_P(Rules, OpacityFlagsCullAndOverride) {
  Workload w = two_walls();
  w.blas[0].geometries[0].opaque = false;
  w.rays[0].flags = kRayCullNoOpaque;
  EXPECT_EQ(trace(w).geometry, 1U);
  w.rays[0].flags = kRayCullOpaque;
  EXPECT_EQ(trace(w).geometry, 0U);
  w.rays[0].flags = kRayOpaque;
  EXPECT_EQ(trace(w, {judged(0, 1)}).geometry, 0U);  // no shader is asked
  w.rays[0].flags = kRaySkipTriangles;
  EXPECT_EQ(trace(w).state, HitState::kMiss);
}

TEST_P(Rules, AnIgnoredCandidateIsPassedAnAcceptedOneIsNot) {
  Workload w = two_walls();
  w.blas[0].geometries[0].opaque = false;
  EXPECT_EQ(trace(w, {judged(0, 1)}).geometry, 1U);
  EXPECT_EQ(trace(w, {judged(0, 0)}).geometry, 0U);
  EXPECT_EQ(trace(w).geometry, 0U);  // never judged: accepted
}

TEST_P(Rules, ATerminatingVerdictEndsTheRayAtThatCandidate) {
  Workload w = two_walls();
  w.blas[0].geometries[0].opaque = false;
  w.blas[0].geometries[1].opaque = false;
  EXPECT_EQ(trace(w, {judged(0, 2), judged(1, 0)}).geometry, 0U);
}

TEST_P(Rules, EqualDistancesGoToTheSmallestIds) {
  Workload w = two_walls();
  w.rays[0].origin = {0, 0, 0};  // on the diagonal both triangles share
  w.tlas[0].instances.push_back(w.tlas[0].instances[0]);
  const Hit hit = trace(w);
  EXPECT_EQ(hit.instance, 0U);
  EXPECT_EQ(hit.geometry, 0U);
  EXPECT_EQ(hit.primitive, 0U);
}

TEST_P(Rules, MirroredShearedAndSingularInstances) {
  Workload w = two_walls();
  Instance& instance = w.tlas[0].instances[0];
  instance.object_to_world.m[0][0] = instance.world_to_object.m[0][0] = -1;
  EXPECT_EQ(trace(w).t, 1);
  instance = Instance{};
  instance.blas = 0;
  instance.object_to_world.m[0][2] = 0.125F;
  instance.world_to_object.m[0][2] = -0.125F;
  EXPECT_EQ(trace(w).t, 1);
  for (auto& row : instance.world_to_object.m) {
    for (float& v : row) {
      v = std::numeric_limits<float>::infinity();
    }
  }
  EXPECT_EQ(trace(w).state, HitState::kMiss);
}

// Found by a reviewer: two instances make a tree whose boxes ended at 2^100.
TEST_P(Rules, InstancesBeyondTwoToTheHundredAreHit) {
  Workload w = two_walls();
  for (Triangle& triangle : w.blas[0].triangles) {
    for (Vec3& v : triangle.v) {
      v = {v.x * 1e31F, v.y * 1e31F, v.z * 1e31F};
    }
  }
  w.rays[0].origin = {0.25e31F, -0.25e31F, 0};
  w.tlas[0].instances.push_back(w.tlas[0].instances[0]);
  EXPECT_EQ(trace(w).t, 1e31F);
  for (Instance& instance : w.tlas[0].instances) {
    instance.world_to_object.m[2][2] = 0.5F;
    instance.object_to_world.m[2][2] = 2;
  }
  EXPECT_EQ(trace(w).t, 2e31F);
}

// Only the program could have confirmed it.
TEST_P(Rules, ACandidateOfAQueryThatNobodyConfirmedIsNoHit) {
  Workload w = two_walls();
  w.blas[0].geometries[0].opaque = false;
  w.rays[0].flags = kRayQuery;
  EXPECT_EQ(trace(w).t, 2);
  EXPECT_EQ(trace(w, {judged(0, 0)}).t, 1);
  w.rays[0].flags = 0;
  EXPECT_EQ(trace(w).t, 1);
}

TEST_P(Rules, ReportedIntersectionsReplayTheShader) {
  Workload w;
  Blas blas;
  blas.aabbs = {{{-1, -1, 1}, {1, 1, 2}}, {{-1, -1, 3}, {1, 1, 4}}};
  blas.geometries = {{0, 2, true}};
  w.blas.push_back(blas);
  w.tlas.resize(1);
  w.tlas[0].instances.resize(1);
  w.tlas[0].instances[0].blas = 0;
  Ray ray;
  ray.dir = {0, 0, 1};
  w.rays.push_back(ray);
  Candidate near = judged(0, 1), far = judged(0, 1), refused = judged(0, 0);
  near.is_report = far.is_report = refused.is_report = 1;
  near.t = 1.5F;
  far.t = 3.5F;
  far.primitive = 1;
  refused.t = 1.25F;
  near.kind = 7;
  const Hit hit = trace(w, {far, refused, near});
  EXPECT_EQ(hit.t, 1.5F);
  EXPECT_EQ(hit.primitive, 0U);
  EXPECT_EQ(hit.kind, 7U);
  EXPECT_EQ(trace(w).state, HitState::kMiss);  // the shader reported nothing
  w.rays[0].flags = kRaySkipAabbs;
  EXPECT_EQ(trace(w, {near}).state, HitState::kMiss);
}

INSTANTIATE_TEST_SUITE_P(Units, Rules, testing::Values("baseline", "a2rt", "cwbvh", "clbvh"),
                         [](const auto& p) { return std::string(p.param); });

}  // namespace
}  // namespace a2rt::rt
