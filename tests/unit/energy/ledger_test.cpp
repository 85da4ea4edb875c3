// Counts times table, nothing free and nothing twice.
#include "a2rt/energy/ledger.h"

#include <gtest/gtest.h>

#include <set>

#include "a2rt/base/error.h"

namespace a2rt::energy {
namespace {

EnergyTable table12() { return EnergyTable::from_file(A2RT_ENERGY_FOLDER "/12nm.csv"); }

TEST(Ledger, every_action_emitted_has_a_row_and_every_row_an_emitter) {
  std::set<std::string> emitted, rows;
  for (const Action& a : possible_actions()) {
    EXPECT_TRUE(emitted.insert(a.component + "." + a.action).second) << a.component << a.action;
  }
  const EnergyTable t = table12();
  for (const Row& row : t.rows()) {
    rows.insert(row.component + "." + row.action);
  }
  EXPECT_EQ(emitted, rows);
}

TEST(Ledger, an_empty_run_costs_nothing) {
  const timing::SimulationResult none;
  EXPECT_TRUE(actions_of(none, Design::kA2rt).empty());
  const Ledger l = make_ledger({}, instances_of(none, {}, Design::kA2rt), 0, table12());
  EXPECT_EQ(l.total_pj(), 0);
}

TEST(Ledger, energy_is_count_times_row_within_its_band) {
  const EnergyTable t = table12();
  const Ledger l = make_ledger({{"box", "test", 1000}}, {}, 1, t);
  const Row& row = t.find("box", "test");
  EXPECT_DOUBLE_EQ(l.total_pj(), 1000 * row.energy_pj);
  EXPECT_DOUBLE_EQ(l.low_pj(), 1000 * row.energy_low_pj);
  EXPECT_DOUBLE_EQ(l.high_pj(), 1000 * row.energy_high_pj);
}

TEST(Ledger, leakage_is_power_times_time_times_instances) {
  const EnergyTable t = table12();
  const Ledger l = make_ledger({}, {{"l1", 8}}, 2, t);
  // 1 uW for 1 ms is 1000 pJ.
  EXPECT_DOUBLE_EQ(l.leakage_pj(), 8 * t.leak_uw("l1") * 2 * 1e3);
}

TEST(Ledger, the_same_quantized_tests_cost_each_design_its_own_tester) {
  timing::SimulationResult r;
  r.testers[static_cast<std::size_t>(timing::Tester::kQBox)].tests = 100;
  const EnergyTable t = table12();
  const double a2rt = make_ledger(actions_of(r, Design::kA2rt), {}, 1, t).total_pj();
  const double aqb8 = make_ledger(actions_of(r, Design::kAqb8), {}, 1, t).total_pj();
  EXPECT_NEAR(a2rt / aqb8, 1.89 / 3.31, 1e-3);
}

TEST(Ledger, testers_that_did_nothing_do_not_leak) {
  timing::SimulationResult r;
  r.testers[static_cast<std::size_t>(timing::Tester::kBox)] = {135, Cycles{6}, Cycles{1}, 7, 7, 0};
  std::uint64_t boxes = 0;
  for (const Instances& i : instances_of(r, {}, Design::kFp32)) {
    EXPECT_NE(i.component, "quantizer");
    boxes += i.component == "box" ? i.count : 0;
  }
  EXPECT_EQ(boxes, 135u);
}

TEST(Ledger, an_action_without_a_row_is_a_user_error) {
  EXPECT_THROW(make_ledger({{"box", "dance", 1}}, {}, 1, table12()), UserError);
}

}  // namespace
}  // namespace a2rt::energy
