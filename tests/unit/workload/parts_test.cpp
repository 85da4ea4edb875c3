// Which parts of the machine a workload calls for.
#include "a2rt/workload/parts.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "a2rt/capture/records.h"
#include "a2rt/workload/synthetic.h"

namespace a2rt {
namespace {

std::set<std::string> names(const Parts& parts) {
  std::set<std::string> all;
  for (std::size_t i = 0; i < kPartCount; ++i) {
    if (parts.has(static_cast<Part>(i))) {
      all.insert(part_name(static_cast<Part>(i)));
    }
  }
  return all;
}

Workload plain(std::uint32_t instances = 1, double masked_share = 0) {
  synthetic::Config config;
  config.primitives = 100;
  config.instances = instances;
  config.masked_share = masked_share;
  config.width = config.height = 8;
  config.secondary = 0;
  return synthetic::make(config);
}

TEST(PartsCalledFor, OneIdentityInstanceOfOpaqueTrianglesNeedsTheTriangleTesterAlone) {
  EXPECT_EQ(names(parts_called_for(plain())), std::set<std::string>{"triangle tester"});
}

TEST(PartsCalledFor, AnInstanceThatIsMovedNeedsTheTransformUnit) {
  EXPECT_TRUE(parts_called_for(plain(3)).has(Part::kTransformUnit));
}

TEST(PartsCalledFor, CandidatesLeaveTheUnitOnlyIfTheProgramCanJudgeThem) {
  Workload w = plain(1, 0.5);
  w.shaders.push_back({static_cast<std::uint32_t>(capture::Stage::kAnyHit), 1, "main"});
  EXPECT_TRUE(parts_called_for(w).has(Part::kAnyHitPath));
  // The same geometry without an any-hit shader: nobody is asked.
  w.candidates.clear();
  w.candidate_first.assign(w.rays.size() + 1, 0);
  std::erase_if(w.shaders, [](const Shader& s) {
    return s.stage == static_cast<std::uint32_t>(capture::Stage::kAnyHit);
  });
  w.segments.clear();
  EXPECT_FALSE(judges_candidates(w));
  EXPECT_FALSE(parts_called_for(w).has(Part::kAnyHitPath));
  // A ray query judges by itself, unless it takes everything for opaque.
  for (Ray& ray : w.rays) {
    ray.flags |= kRayQuery;
  }
  EXPECT_TRUE(parts_called_for(w).has(Part::kAnyHitPath));
  for (Ray& ray : w.rays) {
    ray.flags |= kRayOpaque;
  }
  EXPECT_FALSE(parts_called_for(w).has(Part::kAnyHitPath));
}

TEST(PartsCalledFor, EachRayFlagCallsForItsPart) {
  for (const auto& [flag, part] : {std::pair(kRayCullBackFacing, Part::kFacingTest),
                                   std::pair(kRayNoOpaque, Part::kOpacityLogic),
                                   std::pair(kRaySkipAabbs, Part::kGeometryFilter),
                                   std::pair(kRayTerminateOnFirstHit, Part::kFirstHitExit),
                                   std::pair(kRayQuery, Part::kInlineTraversal)}) {
    Workload w = plain();
    const Parts before = parts_called_for(w);
    EXPECT_FALSE(before.has(part)) << part_name(part);
    w.rays[0].flags |= flag;
    EXPECT_TRUE(parts_called_for(w).has(part)) << part_name(part);
  }
}

TEST(PartsCalledFor, AStructureThatNothingPlacesCallsForNothing) {
  Workload w = plain();
  w.tlas[0].instances.clear();
  EXPECT_EQ(names(parts_called_for(w)), std::set<std::string>{});
}

}  // namespace
}  // namespace a2rt
