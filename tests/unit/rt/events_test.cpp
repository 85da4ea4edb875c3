// The event stream accounts for every record and test, and for nothing else.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "runs.h"

namespace a2rt::rt {
namespace {

using synthetic::Shape;

std::uint64_t count(const EventTotals& t, EventKind kind) {
  return t.events[static_cast<std::size_t>(kind)];
}
std::uint64_t bytes(const EventTotals& t, Traffic kind) {
  return t.traffic[static_cast<std::size_t>(kind)].bytes;
}

EventTotals totals(const std::string& unit, const Workload& w, const std::string& toml = "") {
  return run_functional(*built(unit, w, toml), w).totals;
}

class Stream : public testing::TestWithParam<const char*> {};

TEST_P(Stream, EveryReadLiesInsideOneRegion) {
  const Workload w = scene(Shape::kTorus, 500, 5, 0.3);
  const auto unit = built(GetParam(), w);
  const std::vector<MemoryRegion> regions = unit->regions();
  std::vector<Event> events;
  for (std::size_t i = 0; i < w.rays.size(); ++i) {
    unit->trace({&w.rays[i], candidates_of(w, i)}, events);
  }
  for (const Event& e : events) {
    const bool restores = e.kind == EventKind::kContextPop && e.count > 0;
    if (e.kind != EventKind::kFetch && !restores) {
      EXPECT_EQ(e.bytes, 0U);
      continue;
    }
    EXPECT_GT(e.bytes, 0U);
    EXPECT_TRUE(std::any_of(regions.begin(), regions.end(), [&](const MemoryRegion& r) {
      return e.address >= r.base.value && e.address + e.bytes <= r.base.value + r.bytes.value;
    })) << e.address;
  }
}

TEST_P(Stream, NothingIsPoppedThatWasNotPushedAndOneTestFollowsEveryRead) {
  const Workload w = scene(Shape::kSoup, 500, 5);
  const auto unit = built(GetParam(), w);
  for (std::size_t i = 0; i < w.rays.size(); ++i) {
    std::vector<Event> events;
    unit->trace({&w.rays[i], {}}, events);
    std::int64_t depth = 0, saved = 0;
    for (const Event& e : events) {
      depth += e.kind == EventKind::kPush ? e.count : e.kind == EventKind::kPop ? -1 : 0;
      saved += e.kind == EventKind::kContextPush ? 1 : e.kind == EventKind::kContextPop ? -1 : 0;
      EXPECT_GE(depth, 0);
      EXPECT_GE(saved, 0);
    }
    // A ray that visits all it has pushed leaves no context behind.
    EXPECT_TRUE(depth != 0 || saved == 0) << "ray " << i << " leaves " << saved << " contexts";
  }
}

TEST(PublishedStream, EveryLineChargedBelongsToARegion) {
  const Workload w = scene(Shape::kTorus, 500, 5);
  for (const char* toml : {"[layout]\naccounting = \"published\"", "artifact = true"}) {
    const auto unit = built(toml[0] == 'a' ? "aqb8" : "baseline", w, toml);
    const std::vector<MemoryRegion> regions = unit->regions();
    std::vector<Event> events;
    for (const Ray& ray : w.rays) {
      unit->trace({&ray, {}}, events);
    }
    for (const Event& e : events) {
      if (e.kind == EventKind::kFetch) {
        // Whole lines: they may begin before a region and end after it (and by the strict rule lie
        // just behind it).
        EXPECT_TRUE(std::any_of(regions.begin(), regions.end(), [&](const MemoryRegion& r) {
          return e.address + 64 >= r.base.value && e.address <= r.base.value + r.bytes.value;
        }));
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Units, Stream,
                         testing::Values("baseline", "a2rt", "aqb8", "cwbvh", "clbvh"),
                         [](const auto& p) { return std::string(p.param); });

TEST(Traffic, BaselineReadsItsNodeSizePerBoxTest) {
  const Workload w = scene(Shape::kTorus, 800, 3);
  for (const std::uint64_t size : {33U, 56U, 64U}) {
    const EventTotals t = totals("baseline", w, "[layout]\nnode_bytes = " + std::to_string(size));
    EXPECT_EQ(bytes(t, Traffic::kNode), size * count(t, EventKind::kBoxTest));
    EXPECT_GT(count(t, EventKind::kBoxTest), 0U);
  }
}

TEST(Traffic, TrianglesTake36BytesPerTest) {
  const Workload w = scene(Shape::kSoup, 500);
  const EventTotals t = totals("baseline", w);
  std::uint64_t found = 0;
  for (const Hit& h : hits_of(*built("baseline", w), w)) {
    found += h.state == HitState::kHit ? 1U : 0U;
  }
  EXPECT_GT(found, 0U);
  // Besides the tests, the ids (8 bytes) of every hit that is reported.
  EXPECT_EQ(bytes(t, Traffic::kTriangle), 36 * count(t, EventKind::kTriangleTest) + 8 * found);
}

TEST(Traffic, A2rtReads15BytesPerQuantizedTestAnd45PerGroup) {
  const Workload w = scene(Shape::kTorus, 800, 1);
  const EventTotals t = totals("a2rt", w,
                               "[classify]\narea_ratio = 0.02\nlength_ratio = 0.05\n"
                               "[layout]\nrefetch_group = false");
  EXPECT_EQ(count(t, EventKind::kEscape), 0U);
  EXPECT_EQ(bytes(t, Traffic::kSubNode), 15 * count(t, EventKind::kQBoxTest));
  EXPECT_EQ(bytes(t, Traffic::kGroupNode), 45 * count(t, EventKind::kBoxTest));
  EXPECT_GE(count(t, EventKind::kBoxTest), count(t, EventKind::kQuantizeRay));
}

TEST(Traffic, RefetchedGroupsAreReadOnceMoreEach) {
  const Workload w = scene(Shape::kTorus, 800, 1);
  const std::string knobs = "[classify]\narea_ratio = 0.1\n[layout]\nrefetch_group = ";
  const EventTotals with = totals("a2rt", w, knobs + "true");
  const EventTotals without = totals("a2rt", w, knobs + "false");
  EXPECT_GT(bytes(with, Traffic::kGroupNode), bytes(without, Traffic::kGroupNode));
  EXPECT_EQ(count(with, EventKind::kQuantizeRay), count(without, EventKind::kQuantizeRay));
  EXPECT_EQ((bytes(with, Traffic::kGroupNode) - bytes(without, Traffic::kGroupNode)) % 45, 0U);
}

TEST(Traffic, Aqb8ReadsItsAnchorPerAnchorTestAndItsNodePerQuantizedTest) {
  const Workload w = scene(Shape::kTorus, 800, 3);
  for (const std::uint64_t size : {8U, 16U}) {
    const EventTotals t = totals("aqb8", w, "[layout]\nnode_bytes = " + std::to_string(size));
    EXPECT_EQ(bytes(t, Traffic::kAnchor), 36 * count(t, EventKind::kAnchorTest));
    EXPECT_EQ(bytes(t, Traffic::kSubNode), size * count(t, EventKind::kQBoxTest));
  }
}

TEST(Traffic, Aqb8ArtifactChargesWholeLinesAndTestsUnrelatedSlots) {
  const Workload w = scene(Shape::kTorus, 800, 1);
  const EventTotals right = totals("aqb8", w);
  const EventTotals artifact = totals("aqb8", w, "artifact = true");
  EXPECT_EQ(bytes(artifact, Traffic::kSubNode) % 64, 0U);
  EXPECT_EQ(bytes(artifact, Traffic::kAnchor) % 64, 0U);
  EXPECT_GT(count(artifact, EventKind::kQBoxTest), count(right, EventKind::kQBoxTest));
}

std::uint64_t accesses(const EventTotals& t, Traffic kind) {
  return t.traffic[static_cast<std::size_t>(kind)].accesses;
}

// The slips of AQB8's public code, each by its own mark; source of the averages: lines that records
// of these sizes cover at every offset they can have.
TEST(PublishedAccounting, BaselineDropsANodeLineAndWritesPerTriangleTested) {
  const Workload w = scene(Shape::kTorus, 3000);
  const EventTotals published = totals("baseline", w, "[layout]\naccounting = \"published\"");
  const EventTotals corrected = totals("baseline", w, "[layout]\naccounting = \"corrected\"");
  const std::uint64_t tests = count(published, EventKind::kTriangleTest);
  // Same structures, same order of visits.
  EXPECT_EQ(tests, count(corrected, EventKind::kTriangleTest));
  EXPECT_EQ(count(published, EventKind::kBoxTest), count(corrected, EventKind::kBoxTest));
  // 3 or 4 lines a node, one of them forgotten.
  const std::uint64_t visits =
      accesses(corrected, Traffic::kNode) - accesses(published, Traffic::kNode);
  EXPECT_GT(accesses(published, Traffic::kNode), 2 * visits);
  EXPECT_LT(accesses(published, Traffic::kNode), 3 * visits);
  // An index of 4 bytes spills into the next line by the strict rule at 1 of 16 offsets.
  EXPECT_GT(accesses(published, Traffic::kPrimitiveIndex), tests);
  EXPECT_LT(accesses(published, Traffic::kPrimitiveIndex), tests + tests / 8);
  EXPECT_EQ(accesses(published, Traffic::kResult), accesses(published, Traffic::kPrimitiveIndex));
  EXPECT_GT(accesses(corrected, Traffic::kResult), 0U);
  EXPECT_LT(accesses(corrected, Traffic::kResult), tests / 2);
  EXPECT_EQ(accesses(corrected, Traffic::kResult), accesses(corrected, Traffic::kPrimitiveIndex));
  EXPECT_NEAR(static_cast<double>(accesses(published, Traffic::kTriangle)),
              1.5625 * static_cast<double>(tests), 0.06 * static_cast<double>(tests));
}

TEST(PublishedAccounting, Aqb8AliasesItsNodesAndWritesOncePerHit) {
  const Workload w = scene(Shape::kTorus, 3000);
  // Cheap anchors, so that there are many clusters to lie on one another.
  const std::string many = "artifact = true\n[clusters]\nt_switch = 0.05\n";
  const std::string artifact = many + "[layout]\naccounting = ";
  const EventTotals published = totals("aqb8", w, artifact + "\"published\"");
  const EventTotals corrected = totals("aqb8", w, artifact + "\"corrected\"");
  EXPECT_EQ(published, totals("aqb8", w, many));
  EXPECT_EQ(count(published, EventKind::kQBoxTest), count(corrected, EventKind::kQBoxTest));
  std::uint64_t hits = 0;
  for (const Hit& h : hits_of(*built("aqb8", w, many), w)) {
    hits += h.state == HitState::kHit ? 1U : 0U;
  }
  EXPECT_EQ(accesses(corrected, Traffic::kResult), hits);
  EXPECT_GE(accesses(published, Traffic::kResult), hits);
  EXPECT_LT(accesses(published, Traffic::kResult), hits + hits / 4 + 2);
  // The published nodes of all clusters lie on those of the largest: fewer distinct lines.
  const auto distinct = [&](const std::string& accounting) {
    const auto unit = built("aqb8", w, artifact + accounting);
    std::vector<Event> events;
    for (const Ray& ray : w.rays) {
      unit->trace({&ray, {}}, events);
    }
    std::set<std::uint64_t> lines;
    for (const Event& e : events) {
      if (e.kind == EventKind::kFetch && e.traffic == Traffic::kSubNode) {
        lines.insert(e.address);
      }
    }
    return lines.size();
  };
  EXPECT_LT(distinct("\"published\""), distinct("\"corrected\""));
  EXPECT_THROW(built("aqb8", w, artifact + "\"records\""), UserError);
}

TEST(PublishedAccounting, ChangesNoHit) {
  const Workload w = scene(Shape::kSoup, 500, 3);
  for (const char* accounting : {"published", "corrected"}) {
    const auto unit =
        built("baseline", w, std::string("[layout]\naccounting = \"") + accounting + "\"");
    EXPECT_EQ(differences(w, hits_of(*unit, w)), 0U);
  }
}

TEST(Traffic, CwbvhReadsOneNodePerVisit) {
  const Workload w = scene(Shape::kTorus, 800, 1);
  const EventTotals t = totals("cwbvh", w, "[tree]\nbranching = 8");
  const TrafficTotal& node = t.traffic[static_cast<std::size_t>(Traffic::kNode)];
  EXPECT_EQ(node.bytes, 80 * node.accesses);
  EXPECT_EQ(count(t, EventKind::kDequantize), count(t, EventKind::kBoxTest));
}

TEST(Traffic, EveryInstanceEnteredIsReadAndTransformed) {
  Workload w = scene(Shape::kTorus, 200, 12);
  for (Instance& instance : w.tlas[0].instances) {
    if (instance.world_to_object == Affine{}) {
      instance.blas = kNone;  // it would be entered without a transform
    }
  }
  const EventTotals t = totals("baseline", w);
  EXPECT_GT(count(t, EventKind::kTransform), 0U);
  EXPECT_EQ(bytes(t, Traffic::kInstance), 64 * count(t, EventKind::kTransform));
  EXPECT_EQ(count(t, EventKind::kRaySetup), count(t, EventKind::kTransform) + w.rays.size());
}

TEST(Traffic, AnIdentityInstanceIsReadButNeverTransformedAndItsHitsAreTheSame) {
  for (const char* unit : {"baseline", "a2rt", "aqb8", "cwbvh", "clbvh"}) {
    Workload w = scene(Shape::kTorus, 200);
    w.tlas[0].instances[0].object_to_world = w.tlas[0].instances[0].world_to_object = Affine{};
    const auto built_unit = built(unit, w);
    const FunctionalResult identity = run_functional(*built_unit, w);
    EXPECT_EQ(count(identity.totals, EventKind::kTransform), 0U);
    EXPECT_EQ(count(identity.totals, EventKind::kRaySetup), w.rays.size());
    EXPECT_EQ(bytes(identity.totals, Traffic::kInstance), 64 * w.rays.size());
    // A translation by nothing that is not recognised as the identity: the transform changes no
    // ray.
    w.tlas[0].instances[0].world_to_object.m[0][3] = std::numeric_limits<float>::denorm_min();
    const FunctionalResult moved = run_functional(*built(unit, w), w);
    EXPECT_EQ(count(moved.totals, EventKind::kTransform), w.rays.size());
    EXPECT_EQ(moved.hits, identity.hits) << unit;
  }
}

TEST(Traffic, AlphaAndProceduralCandidatesLeaveTheUnit) {
  EXPECT_EQ(count(totals("baseline", scene(Shape::kSoup, 300)), EventKind::kAnyHit), 0U);
  EXPECT_GT(count(totals("baseline", scene(Shape::kSoup, 300, 1, 0.5)), EventKind::kAnyHit), 0U);
  const EventTotals spheres = totals("baseline", scene(Shape::kSpheres, 60));
  EXPECT_GT(count(spheres, EventKind::kIntersection), 0U);
  EXPECT_EQ(count(spheres, EventKind::kTriangleTest), 0U);
}

TEST(Traffic, SiblingAlignmentPlacesEveryNodeReadOnItsBoundary) {
  const Workload w = scene(Shape::kTorus, 800, 1);
  const auto unit = built("baseline", w, "[layout]\nsibling_alignment = 64");
  std::vector<Event> events;
  unit->trace({&w.rays[w.rays.size() / 2], {}}, events);
  for (const Event& e : events) {
    if (e.kind == EventKind::kFetch && e.traffic == Traffic::kNode) {
      EXPECT_EQ(e.address % 64, 0U);
    }
  }
}

}  // namespace
}  // namespace a2rt::rt
