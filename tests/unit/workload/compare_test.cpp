#include "a2rt/workload/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "a2rt/base/error.h"
#include "a2rt/capture/records.h"
#include "a2rt/workload/effects.h"
#include "a2rt/workload/exact_walk.h"
#include "a2rt/workload/reference.h"
#include "a2rt/workload/synthetic.h"
#include "a2rt/workload/verdicts.h"
#include "scratch_folder.h"

namespace a2rt {
namespace {

using capture::VerdictAction;
using capture::VerdictEntry;
using ::testing::HasSubstr;

// Three parallel squares at z = 1, 2 and 2.000001, rays along +z; the driver hits z = 2.
class Compared : public ::testing::Test {
 protected:
  void SetUp() override {
    Blas blas;
    for (const float z : {1.0f, 2.0f, 2.000001f}) {
      const Vec3 a{-1, -1, z}, b{1, -1, z}, c{1, 1, z};
      blas.triangles.push_back({{a, b, c}});
    }
    blas.geometries.push_back({0, 3, true});
    w_.blas.push_back(blas);
    Instance instance;
    instance.blas = 0;
    w_.tlas.push_back({{instance}, {}});
    Ray ray;
    ray.origin = {0.5f, 0.25f, 0};
    ray.dir = {0, 0, 1};
    w_.rays.push_back(ray);
    w_.driver_hits.push_back(at(1, 2));
  }
  static Hit at(std::uint32_t primitive, float t) {
    return {HitState::kHit, t, 0, 0, primitive, 0xFE};
  }
  Match match(const Hit& unit) const { return compare_hit(w_, 0, unit); }
  Workload w_;
};

TEST_F(Compared, EqualHitsAreTheSame) {
  EXPECT_EQ(match(at(1, 2)), Match::kSame);
  w_.driver_hits[0] = Hit{};
  EXPECT_EQ(match(Hit{}), Match::kSame);
}
TEST_F(Compared, AnotherPrimitiveAtTheSameDistanceIsATie) {
  EXPECT_EQ(match(at(2, 2)), Match::kTie);
  EXPECT_EQ(match(at(2, 2.000001f)), Match::kTie);
}
TEST_F(Compared, ANearerHitThatTheDriversTestAcceptsIsTheDriversLoss) {
  EXPECT_EQ(match(at(0, 1)), Match::kDriverBoxLoss);
  w_.driver_hits[0] = Hit{};
  EXPECT_EQ(match(at(0, 1)), Match::kDriverBoxLoss);
}
TEST_F(Compared, AMissingHitIsLost) {
  EXPECT_EQ(match(Hit{}), Match::kLost);
  w_.driver_hits[0] = at(0, 1);
  EXPECT_EQ(match(at(1, 2)), Match::kLost);
}
TEST_F(Compared, AHitThatNobodyElseSeesIsOther) {
  w_.rays[0].flags = kRayCullFrontFacing | kRayCullBackFacing;
  w_.driver_hits[0] = Hit{};
  EXPECT_EQ(match(at(0, 1)), Match::kOther);
}
TEST_F(Compared, HitsAtTheBeginOfTheRayAreSelfHits) {
  w_.rays[0].origin.z = 1;
  w_.driver_hits[0] = at(1, 1);
  EXPECT_EQ(match(at(0, 1e-9f)), Match::kTminSelfHit);
}
TEST_F(Compared, HitsOnTheBorderOfATriangleAreEdges) {
  w_.rays[0].origin = {1, 0.25f, 0};  // on the edge x = 1
  w_.driver_hits[0] = at(0, 1);
  EXPECT_EQ(match(Hit{}), Match::kEdge);
  w_.rays[0].origin = {0.99f, 0.25f, 0};
  EXPECT_EQ(match(Hit{}), Match::kLost);
}
TEST_F(Compared, OcclusionRaysOnlyAskWhether) {
  w_.rays[0].flags = kRayTerminateOnFirstHit | kRaySkipClosestHit;
  w_.driver_hits[0].state = HitState::kHitInferred;
  EXPECT_EQ(match(at(0, 1)), Match::kSame);
  EXPECT_EQ(match(Hit{}), Match::kLost);
}
TEST_F(Compared, UnknownIsNotCompared) {
  w_.driver_hits[0].state = HitState::kUnknown;
  EXPECT_EQ(match(at(0, 1)), Match::kUnknown);
}
TEST_F(Compared, ReportsKeepTheFirstExamplesOfEachKind) {
  MatchReport a, b;
  a.keep = b.keep = 2;
  for (int i = 0; i < 3; ++i) {
    a.add(w_, 0, Hit{});
    b.add(w_, 0, at(2, 2));
    b.add(w_, 0, at(1, 2));
  }
  a.merge(b);
  EXPECT_EQ(a.count(Match::kLost), 3u);
  EXPECT_EQ(a.count(Match::kTie), 3u);
  EXPECT_EQ(a.count(Match::kSame), 3u);
  EXPECT_EQ(a.examples.size(), 4u);
}

// A workload whose driver is the exact walk and whose unit misses or replaces hits.
class Verdicts : public ::testing::Test {
 protected:
  void SetUp() override {
    synthetic::Config config;
    config.primitives = 3000;
    config.width = config.height = 24;
    config.driver_nodes = true;
    config.reference = false;
    w_ = synthetic::make(config);
    const ExactWalk walk(w_);
    for (std::size_t i = 0; i < w_.rays.size(); ++i) {
      w_.driver_hits[i] = walk.walk(w_.rays[i], {}).hit;
    }
    units_ = w_.driver_hits;
  }
  Workload w_;
  std::vector<Hit> units_;
};

TEST_F(Verdicts, AgreementNeedsNone) {
  VerdictSummary summary;
  decide_verdicts(w_, units_, {}, summary);
  EXPECT_EQ(summary.entries, 0u);
  EXPECT_EQ(summary.changed, 0u);
}

TEST_F(Verdicts, TheDriverFindsTheUnitsHitUnderThem) {
  // The unit that loses the nearest hit of every ray: what does the driver find behind it?
  const ExactWalk walk(w_);
  std::size_t farther = 0;
  for (std::size_t i = 0; i < w_.rays.size(); ++i) {
    if (units_[i].state == HitState::kHit) {
      Ray behind = w_.rays[i];
      behind.tmin = units_[i].t;
      units_[i] = walk.walk(behind, {}).hit;
      farther += units_[i].state == HitState::kHit ? 1U : 0U;
    }
  }
  ASSERT_GT(farther, 20u);
  VerdictSummary summary;
  const auto entries = decide_verdicts(w_, units_, {}, summary);
  EXPECT_EQ(summary.unrealisable, 0u);
  EXPECT_GT(summary.entries, farther / 2);
  for (std::size_t i = 0; i < w_.rays.size(); ++i) {
    Ray ray = w_.rays[i];
    if (entries[i].action == static_cast<std::uint32_t>(VerdictAction::kInterval)) {
      ray.tmin = entries[i].tmin;
      ray.tmax = entries[i].tmax;
    } else if (entries[i].action == static_cast<std::uint32_t>(VerdictAction::kForceMiss)) {
      ray.mask = 0;
    }
    EXPECT_TRUE(same_answer(ray, walk.walk(ray, {}).hit, units_[i])) << i;
  }
  // The next pass records the unit's own hits; nothing changes any more.
  const VerdictTable table(w_, entries);
  Workload second = w_;
  second.driver_hits = units_;
  VerdictSummary settled;
  const auto again = decide_verdicts(second, units_, table, settled);
  EXPECT_EQ(settled.changed, 0u);
  EXPECT_EQ(settled.entries, summary.entries);
}

TEST_F(Verdicts, HitsThatTheDriverCannotFindAreCounted) {
  for (std::size_t i = 0; i < w_.rays.size(); ++i) {
    if (units_[i].state == HitState::kMiss) {
      units_[i] = {HitState::kHit, 1, 0, 0, 0, 0xFE};  // nobody sees this one
      VerdictSummary summary;
      const auto entries = decide_verdicts(w_, units_, {}, summary);
      EXPECT_EQ(summary.unrealisable, 1u);
      EXPECT_EQ(summary.entries, 0u);
      return;
    }
  }
  FAIL() << "no miss";
}

TEST_F(Verdicts, PassesDoNotAlternateOverUnjudgedCandidates) {
  // Everything is masked; the unit's hit was ignored by the shader, its next guess is a miss.
  w_.blas[0].geometries[0].opaque = false;
  std::size_t ray = 0;
  while (w_.driver_hits[ray].state != HitState::kHit) {
    ++ray;
  }
  Workload forced = w_;
  forced.rays[ray].flags |= kRayOverridden;
  forced.driver_hits[ray] = Hit{};
  // Pass 1 knows the verdict and forces a miss.
  std::vector<Hit> misses = w_.driver_hits;
  misses[ray] = Hit{};
  VerdictSummary first;
  const VerdictTable table(w_, decide_verdicts(w_, misses, {}, first));
  EXPECT_EQ(first.entries, 1u);
  // Pass 2 records no candidates, so the unit takes its hit for accepted.
  VerdictSummary second;
  decide_verdicts(forced, w_.driver_hits, table, second);
  EXPECT_EQ(second.changed, 0u);
  EXPECT_EQ(second.entries, 1u);
  // But if the program traces another ray there, the entry is not its.
  forced.rays[ray].tmax *= 2;
  VerdictSummary other;
  decide_verdicts(forced, w_.driver_hits, table, other);
  EXPECT_EQ(other.changed, 1u);
  // And an opaque hit needs no shader.
  forced.rays[ray].tmax = w_.rays[ray].tmax;
  forced.blas[0].geometries[0].opaque = true;
  VerdictSummary opaque;
  decide_verdicts(forced, w_.driver_hits, table, opaque);
  EXPECT_EQ(opaque.changed, 1u);
}

TEST_F(Verdicts, FilesRoundTripAndAreCanonical) {
  const testing::ScratchFolder folder;
  std::vector<VerdictEntry> entries(w_.rays.size(), VerdictEntry{0, 0, 0, 0});
  for (std::size_t i = 0; i < entries.size(); i += 5) {
    entries[i] = {static_cast<std::uint32_t>(i % 10 == 0 ? VerdictAction::kForceMiss
                                                         : VerdictAction::kInterval),
                  0.5f, static_cast<float>(i), 0};
  }
  VerdictTable(w_, entries).write(folder.path() / "v");
  const VerdictTable read = VerdictTable::read(folder.path() / "v");
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Ray& ray = w_.rays[i];
    const VerdictEntry found = read.find(ray.dispatch, ray.launch, ray.ordinal);
    EXPECT_EQ(found.action, entries[i].action) << i;
    EXPECT_EQ(found.tmax, entries[i].tmax) << i;
  }
  EXPECT_EQ(read.find(7, 0, 0).action, 0u);
  EXPECT_EQ(read.find(0, 0, 99).action, 0u);
  EXPECT_EQ(read.find(0, 99999, 0).action, 0u);
  read.write(folder.path() / "again");
  const auto bytes = [&](const char* name) {
    std::ifstream in(folder.path() / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  EXPECT_EQ(bytes("v"), bytes("again"));
  // Cut off anywhere it is refused.
  const std::string whole = bytes("v");
  for (std::size_t length = 0; length < whole.size(); length += 41) {
    std::ofstream(folder.path() / "cut", std::ios::binary) << whole.substr(0, length);
    EXPECT_THROW(VerdictTable::read(folder.path() / "cut"), UserError) << length;
  }
}

std::uint64_t rays_of(const Effects& effects, Effect effect) {
  return effects.uses[static_cast<std::size_t>(effect)].rays;
}

TEST(EffectsOf, APlainSceneCallsForLittle) {
  synthetic::Config config;
  config.secondary = 0;
  const Effects e = derive_effects(synthetic::make(config));
  for (const EffectUse& use : e.uses) {
    const bool expected = use.effect == Effect::kTriangles || use.effect == Effect::kClosestHit;
    EXPECT_EQ(use.used, expected) << use.name;
    EXPECT_EQ(use.reason.starts_with("no "), !expected) << use.reason;
  }
}

TEST(EffectsOf, EveryFeatureIsFoundWithItsRays) {
  synthetic::Config config;
  config.masked_share = 0.5;
  config.instances = 12;
  config.primitives = 200;
  config.width = config.height = 12;
  Workload w = synthetic::make(config);
  const Effects e = derive_effects(w);
  EXPECT_TRUE(e.used(Effect::kAnyHit));
  EXPECT_TRUE(e.used(Effect::kTransform));
  EXPECT_TRUE(e.used(Effect::kInstancing));
  EXPECT_TRUE(e.used(Effect::kMasks));
  EXPECT_TRUE(e.used(Effect::kTextures));
  EXPECT_FALSE(e.used(Effect::kProcedural));
  EXPECT_EQ(rays_of(e, Effect::kFirstHit), w.rays.size() / 3);
  EXPECT_EQ(rays_of(e, Effect::kSecondaryRays), w.rays.size() / 3 * 2);
  w.rays[5].flags |= kRayQuery | kRayCullBackFacing | kRaySkipAabbs;
  w.rays[5].parent = 1;
  const Effects more = derive_effects(w);
  EXPECT_EQ(rays_of(more, Effect::kRayQuery), 1u);
  EXPECT_EQ(rays_of(more, Effect::kFaceCulling), 1u);
  EXPECT_EQ(rays_of(more, Effect::kSkipGeometry), 1u);
  EXPECT_EQ(rays_of(more, Effect::kRecursion), 1u);
}

TEST(EffectsOf, ProceduralGeometryNeedsItsIntersectionShader) {
  synthetic::Config config;
  config.shape = synthetic::Shape::kSpheres;
  const Effects e = derive_effects(synthetic::make(config));
  EXPECT_TRUE(e.used(Effect::kProcedural));
  EXPECT_GT(rays_of(e, Effect::kProcedural), 0u);
  EXPECT_FALSE(e.used(Effect::kTriangles));
}

}  // namespace
}  // namespace a2rt
