// Every parameter changes what it says it changes, and wrong ones are refused.
#include <gtest/gtest.h>

#include "a2rt/base/error.h"
#include "runs.h"

namespace a2rt::rt {
namespace {

using synthetic::Shape;

StructureStats structure(const std::string& unit, const Workload& w, const std::string& toml = "") {
  return built(unit, w, toml)->structure();
}

FunctionalResult audited(const std::string& unit, const Workload& w, const std::string& toml) {
  FunctionalOptions options;
  options.audit_rays = w.rays.size();
  return run_functional(*built(unit, w, toml), w, options);
}

TEST(Knobs, WiderTreesHaveFewerInnerNodes) {
  const Workload w = scene(Shape::kTorus, 2000);
  EXPECT_LT(structure("baseline", w, "[tree]\nbranching = 8").inner_nodes,
            structure("baseline", w, "[tree]\nbranching = 2").inner_nodes);
}

TEST(Knobs, SmallerLeavesMakeMoreOfThem) {
  const Workload w = scene(Shape::kTorus, 2000);
  EXPECT_GT(structure("baseline", w, "[tree]\nmax_leaf = 1").leaf_nodes,
            structure("baseline", w).leaf_nodes);
}

TEST(Knobs, EachThresholdAloneMakesGroups) {
  const Workload w = scene(Shape::kSoup, 2000);
  const auto groups = [&](const std::string& area, const std::string& length) {
    return structure("a2rt", w, "[classify]\narea_ratio = " + area + "\nlength_ratio = " + length)
        .group_nodes;
  };
  EXPECT_GT(groups("0.2", "0.0"), groups("0.0", "0.0"));
  EXPECT_GT(groups("0.0", "0.2"), groups("0.0", "0.0"));
}

TEST(Knobs, LeavesThatFailTheClassificationCanOpenGroups) {
  const Workload w = scene(Shape::kSoup, 2000);
  EXPECT_GT(structure("a2rt", w, "[classify]\narea_ratio = 0.2\nleaf = 'group'").group_nodes,
            structure("a2rt", w, "[classify]\narea_ratio = 0.2\nleaf = 'sub'").group_nodes);
}

TEST(Knobs, FewerBoxBitsTakeFewerBytesAndMoreRedundantHits) {
  const Workload w = scene(Shape::kSoup, 2000);
  const auto coarse = audited("a2rt", w, "[precision]\nbox_bits = 4");
  const auto fine = audited("a2rt", w, "[precision]\nbox_bits = 12");
  EXPECT_GT(coarse.audit.redundant_hits, fine.audit.redundant_hits);
  EXPECT_EQ(coarse.audit.missed_hits, 0U);
  EXPECT_EQ(fine.audit.missed_hits, 0U);
  EXPECT_LT(structure("a2rt", w, "[precision]\nbox_bits = 4").sub_bytes,
            structure("a2rt", w, "[precision]\nbox_bits = 12").sub_bytes);
}

TEST(Knobs, EveryPrecisionKnobIsAcceptedAndKeepsTheHits) {
  const Workload w = scene(Shape::kTorus, 800, 3);
  for (const char* knob :
       {"origin = 'guard'", "origin_bits = 12", "direction = 's5'", "direction = 'fp16'",
        "direction = 'fp32'", "scales = 'single'", "multiplier_columns = 0",
        "multiplier_columns = 8", "low_columns = 'drop'", "box_bits = 5", "box_bits = 10"}) {
    const auto unit = built("a2rt", w, std::string("[precision]\n") + knob);
    EXPECT_EQ(unit->info().promise, Promise::kConservative) << knob;
    EXPECT_EQ(differences(w, hits_of(*unit, w)), 0U) << knob;
  }
  EXPECT_EQ(make_unit("a2rt", "[precision]\nrounding = 'nearest'")->info().promise,
            Promise::kMayMiss);
}

TEST(Knobs, FrontToBackAndRetestSaveTriangleTests) {
  const Workload w = scene(Shape::kSoup, 3000);
  const auto tests = [&](const std::string& toml) {
    return run_functional(*built("baseline", w, toml), w)
        .totals.events[static_cast<std::size_t>(EventKind::kTriangleTest)];
  };
  const auto best = tests("");
  EXPECT_LT(best, tests("[traversal]\nfront_to_back = false"));
  EXPECT_LT(best, tests("[traversal]\nretest_on_pop = false"));
}

TEST(Knobs, AnchorsGetRarerWhenTheyCostMore) {
  const Workload w = scene(Shape::kSoup, 3000);
  EXPECT_LT(structure("aqb8", w, "[clusters]\nt_switch = 10.0").group_nodes,
            structure("aqb8", w, "[clusters]\nt_switch = 0.1").group_nodes);
}

TEST(Knobs, UnknownKeysAndWrongValuesAreErrors) {
  EXPECT_THROW(make_unit("a2rt", "[precision]\nbox_bitz = 8"), UserError);
  EXPECT_THROW(make_unit("a2rt", "[precision]\nbox_bits = 13"), UserError);
  EXPECT_THROW(make_unit("baseline", "[layout]\nnode_bytes = 20"), UserError);
  EXPECT_THROW(make_unit("cwbvh", "[tree]\nmax_leaf = 7"), UserError);
  EXPECT_THROW(make_unit("aqb8", "[layout]\nnode_bytes = 12"), UserError);
  EXPECT_THROW(make_unit("aqb8", "rounding = 'up'"), UserError);
}

}  // namespace
}  // namespace a2rt::rt
