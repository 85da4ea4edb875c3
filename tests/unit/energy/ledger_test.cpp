// Counts times table, nothing free and nothing twice.
#include "a2rt/energy/ledger.h"

#include <gtest/gtest.h>

#include <algorithm>
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

std::uint64_t count_of(const std::vector<Action>& actions, const std::string& component,
                       const std::string& action) {
  std::uint64_t count = 0;
  for (const Action& a : actions) {
    count += a.component == component && a.action == action ? a.count : 0;
  }
  return count;
}

TEST(Ledger, contexts_that_are_fetched_again_cost_no_context_buffer) {
  timing::SimulationResult r;
  r.rt.events[static_cast<std::size_t>(EventKind::kContextPush)] = 9;
  r.rt.context_refetches = 9;
  r.rt.context_refetch_steps = 18;
  const std::vector<Action> actions = actions_of(r, Design::kA2rt);
  EXPECT_EQ(count_of(actions, "rt_context", "push"), 0u);
  EXPECT_EQ(count_of(actions, "ray_buffer", "read_fp32"), 18u);
  timing::MachineConfig machine;
  const auto has_buffer = [&] {
    const auto all = instances_of(r, machine, Design::kA2rt);
    return std::any_of(all.begin(), all.end(),
                       [](const Instances& i) { return i.component == "rt_context"; });
  };
  EXPECT_TRUE(has_buffer());
  machine.rt.context = timing::ContextPolicy::kRefetch;
  EXPECT_FALSE(has_buffer());
}

TEST(Ledger, stack_energy_counts_entries_and_what_moves_between_stack_and_memory) {
  timing::SimulationResult r;
  r.rt.events[static_cast<std::size_t>(EventKind::kPush)] = 1;
  r.rt.stack_pushed = 5;
  r.rt.stack_popped = 4;
  r.rt.stack_spilled = 2;
  r.rt.stack_filled = 3;
  const std::vector<Action> actions = actions_of(r, Design::kFp32);
  EXPECT_EQ(count_of(actions, "rt_stack", "push"), 8u);
  EXPECT_EQ(count_of(actions, "rt_stack", "pop"), 6u);
}

TEST(Ledger, what_a_cache_writes_back_is_read_from_it) {
  timing::SimulationResult r;
  r.l1.written_back = 3;
  r.l2.written_back = 4;
  const std::vector<Action> actions = actions_of(r, Design::kFp32);
  EXPECT_EQ(count_of(actions, "l1", "read_sector"), 3u);
  EXPECT_EQ(count_of(actions, "l2", "read_sector"), 4u);
}

TEST(Ledger, an_action_without_a_row_is_a_user_error) {
  EXPECT_THROW(make_ledger({{"box", "dance", 1}}, {}, 1, table12()), UserError);
}

}  // namespace
}  // namespace a2rt::energy
