// Every unit against brute force, and the independence of results from things that must not matter.
#include <gtest/gtest.h>

#include <algorithm>

#include "a2rt/base/error.h"
#include "a2rt/rt/a2rt_unit.h"
#include "a2rt/rt/tree_unit.h"
#include "runs.h"

namespace a2rt::rt {
namespace {

using synthetic::Shape;

struct Case {
  Shape shape;
  std::uint32_t primitives, instances;
  double masked;
};
const Case kCases[] = {{Shape::kSoup, 600, 1, 0},    {Shape::kSphere, 500, 1, 0},
                       {Shape::kTorus, 500, 9, 0},   {Shape::kGrid, 300, 1, 0},
                       {Shape::kSlivers, 300, 3, 0}, {Shape::kSpheres, 120, 1, 0},
                       {Shape::kSpheres, 60, 5, 0},  {Shape::kSoup, 400, 4, 0.4},
                       {Shape::kSoup, 3, 1, 0},      {Shape::kTorus, 400, 40, 0.3}};

class SafeUnit : public testing::TestWithParam<const char*> {};

TEST_P(SafeUnit, FindsWhatBruteForceFinds) {
  for (const Case& c : kCases) {
    const Workload w = scene(c.shape, c.primitives, c.instances, c.masked);
    const auto unit = built(GetParam(), w);
    EXPECT_EQ(differences(w, hits_of(*unit, w)), 0U)
        << "shape " << static_cast<int>(c.shape) << ", " << c.instances << " instances";
  }
}

TEST_P(SafeUnit, OrderOfVisitsDoesNotChangeTheHits) {
  const Workload w = scene(Shape::kTorus, 500, 6, 0.3);
  for (const char* order :
       {"front_to_back = false", "retest_on_pop = false", "far_first = true",
        "leaves_at_once = true", "front_to_back = false\nretest_on_pop = false"}) {
    const auto unit = built(GetParam(), w, std::string("[traversal]\n") + order);
    EXPECT_EQ(differences(w, hits_of(*unit, w)), 0U) << order;
  }
}

TEST_P(SafeUnit, TreeWidthAndLeafSizeDoNotChangeTheHits) {
  const Workload w = scene(Shape::kSoup, 700, 2, 0.2);
  for (const int width : {2, 3, 8}) {
    const auto unit =
        built(GetParam(), w, "[tree]\nmax_leaf = 2\nbranching = " + std::to_string(width));
    EXPECT_EQ(differences(w, hits_of(*unit, w)), 0U) << width;
  }
}

INSTANTIATE_TEST_SUITE_P(Units, SafeUnit, testing::Values("baseline", "a2rt", "cwbvh", "clbvh"),
                         [](const auto& p) { return std::string(p.param); });

class AnyUnit : public testing::TestWithParam<std::string> {};

TEST_P(AnyUnit, HasNoMoreLossesThanItsPromiseAllows) {
  for (const Case& c : kCases) {
    const Workload w = scene(c.shape, c.primitives, c.instances, c.masked);
    const auto unit = built(GetParam(), w);
    const std::uint64_t lost = differences(w, hits_of(*unit, w));
    if (unit->info().promise == Promise::kMayMiss) {
      // Ordinary rays: losses are corner cases, not a way of life.
      EXPECT_LE(lost, w.rays.size() / 50) << "shape " << static_cast<int>(c.shape);
    } else {
      EXPECT_EQ(lost, 0U);
    }
  }
}

TEST_P(AnyUnit, ResultsAreTheSameForAnyNumberOfThreads) {
  const Workload w = scene(Shape::kTorus, 500, 5, 0.3);
  const auto unit = built(GetParam(), w);
  FunctionalOptions options;
  options.audit_rays = 200;
  const FunctionalResult one = run_functional(*unit, w, options);
  options.threads = 3;
  const FunctionalResult three = run_functional(*unit, w, options);
  EXPECT_EQ(one.hits, three.hits);
  EXPECT_EQ(one.totals, three.totals);
  EXPECT_EQ(one.audited_rays, 200U);
  EXPECT_EQ(three.audited_rays, 200U);
  EXPECT_EQ(one.audit.redundant_hits, three.audit.redundant_hits);
  EXPECT_EQ(one.audit.missed_by_mechanism, three.audit.missed_by_mechanism);
}

TEST_P(AnyUnit, TracingWithEventsOrAuditFindsTheSameHits) {
  const Workload w = scene(Shape::kSoup, 500, 3, 0.3);
  const auto unit = built(GetParam(), w);
  for (std::size_t i = 0; i < w.rays.size(); ++i) {
    const RayInput input{&w.rays[i], candidates_of(w, i)};
    std::vector<Event> events;
    Audit audit;
    const Hit plain = unit->trace(input);
    EXPECT_EQ(plain, unit->trace(input, events));
    EXPECT_EQ(plain, unit->trace(input, audit));
  }
}

TEST_P(AnyUnit, InactiveRaysMissAndDoNotThrow) {
  const Workload w = scene(Shape::kSphere, 200);
  const auto unit = built(GetParam(), w);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  Ray ray = w.rays[0];
  for (const float bad : {nan, inf, -inf}) {
    Ray r = ray;
    r.dir.y = bad;
    EXPECT_EQ(unit->trace({&r, {}}).state, HitState::kMiss);
    r = ray;
    r.origin.x = bad;
    EXPECT_EQ(unit->trace({&r, {}}).state, HitState::kMiss);
  }
  ray.tmin = 5;
  ray.tmax = 4;
  EXPECT_EQ(unit->trace({&ray, {}}).state, HitState::kMiss);
  ray.tlas = 7;
  EXPECT_EQ(unit->trace({&ray, {}}).state, HitState::kMiss);
}

TEST_P(AnyUnit, AnEmptySceneIsBuiltAndMissed) {
  Workload w = scene(Shape::kSphere, 200);
  w.blas[0].triangles.clear();
  w.blas[0].geometries[0].count = 0;
  const auto unit = built(GetParam(), w);
  EXPECT_EQ(unit->trace({&w.rays[0], {}}).state, HitState::kMiss);
}

TEST_P(AnyUnit, NanTrianglesAreSkippedNotPropagated) {
  Workload w = scene(Shape::kSphere, 300);
  for (std::size_t i = 0; i < w.blas[0].triangles.size(); i += 7) {
    w.blas[0].triangles[i].v[1].z = std::numeric_limits<float>::quiet_NaN();
  }
  const auto unit = built(GetParam(), w);
  const std::uint64_t lost = differences(w, hits_of(*unit, w));
  EXPECT_LE(lost, unit->info().promise == Promise::kMayMiss ? w.rays.size() / 50 : 0U);
}

TEST_P(AnyUnit, InstancesOutsideTheWorkloadAreRefused) {
  Workload w = scene(Shape::kSphere, 100);
  w.tlas[0].instances[0].blas = 99;
  EXPECT_THROW(built(GetParam(), w), UserError);
}

// Whatever registered itself: a new unit is held to its promise without an edit here.
INSTANTIATE_TEST_SUITE_P(Units, AnyUnit, testing::ValuesIn(unit_registry().names()),
                         [](const auto& p) {
                           std::string name = p.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// A2RT with the children of every node in another order of slots.
struct Shuffled : A2rtUnit {
  explicit Shuffled(A2rtUnit unit) : A2rtUnit(std::move(unit)) {}
  A2rtTree encode(bvh::WideBvh& tree, const std::string& name, bvh::AddressSpace& space,
                  StructureStats& stats) const {
    synthetic::Random random(9);
    for (const bvh::BvhRecord& r : tree.records) {
      for (std::uint32_t k = r.count; !r.leaf() && k > 1; --k) {
        std::swap(tree.records[r.first + k - 1], tree.records[r.first + random.below(k)]);
      }
    }
    return A2rtUnit::encode(tree, name, space, stats);
  }
};

TEST(SlotOrder, ShufflingTheChildrenOfEveryNodeChangesNoHit) {
  const config::Section section = config::Section::from_text("", "test");
  for (const Shape shape : {Shape::kGrid, Shape::kTorus, Shape::kSlivers}) {
    const Workload w = scene(shape, 800, 3);
    TreeUnit<Shuffled> shuffled(
        Shuffled(A2rtUnit(section, "a2rt", "", arith::OriginDesign::kWide)));
    shuffled.build(w);
    EXPECT_EQ(differences(w, hits_of(shuffled, w)), 0U);
  }
}

TEST(UnitRegistryTest, KnowsTheUnitsAndRefusesADuplicate) {
  const std::vector<std::string> names = unit_registry().names();
  for (const char* name : {"a2rt", "a2rt-literal", "aqb8", "baseline", "clbvh", "cwbvh"}) {
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
  }
  EXPECT_THROW(unit_registry().add("baseline", {}), InternalError);
  EXPECT_THROW(make_unit("nonesuch"), UserError);
}

}  // namespace
}  // namespace a2rt::rt
