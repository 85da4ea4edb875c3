// Sampling: representative, repeatable, and right where everything is equal.
#include "a2rt/timing/sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "mocks.h"

namespace a2rt::timing::test {
namespace {

std::vector<WarpPlace> places(std::size_t warps, std::uint32_t dispatches = 1) {
  std::vector<WarpPlace> all(warps);
  for (std::size_t i = 0; i < warps; ++i) {
    all[i].dispatch = static_cast<std::uint32_t>(i * dispatches / warps);
  }
  return all;
}

TEST(Sampling, takes_the_asked_share_of_every_dispatch_in_whole_blocks) {
  const std::size_t warps = 160 * kBlockWarps;
  const SamplePlan plan = plan_sample(places(warps, 2), std::vector<double>(warps, 1.0), 0.1, 1);
  std::size_t of_the_first = 0;
  std::map<std::uint32_t, std::size_t> blocks;
  for (const std::uint32_t warp : plan.warps) {
    of_the_first += plan.dispatch[warp] == 0;
    ++blocks[plan.block[warp]];
  }
  EXPECT_EQ(plan.warps.size(), 16 * kBlockWarps);
  EXPECT_EQ(of_the_first, 8 * kBlockWarps);
  EXPECT_EQ(blocks.size(), 16u);
  EXPECT_DOUBLE_EQ(plan.cost_chosen / plan.cost_all, 0.1);
  const std::set<std::uint32_t> different(plan.warps.begin(), plan.warps.end());
  EXPECT_EQ(different.size(), plan.warps.size());
}

TEST(Sampling, cheap_and_dear_blocks_have_their_share) {
  // A dear block after every three cheap ones: drawn by place, every fourth would be all or
  // nothing.
  std::vector<double> costs(160 * kBlockWarps);
  for (std::size_t warp = 0; warp < costs.size(); ++warp) {
    costs[warp] = warp / kBlockWarps % 4 == 3 ? 100 : 1;
  }
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const SamplePlan plan = plan_sample(places(costs.size()), costs, 0.25, seed);
    EXPECT_DOUBLE_EQ(plan.cost_chosen / plan.cost_all, 0.25) << seed;
  }
}

TEST(Sampling, the_same_seed_draws_the_same_warps_and_another_seed_does_not) {
  const std::size_t warps = 160 * kBlockWarps;
  const auto drawn = [&](std::uint64_t seed) {
    return plan_sample(places(warps), std::vector<double>(warps, 1.0), 0.1, seed).warps;
  };
  EXPECT_EQ(drawn(7), drawn(7));
  EXPECT_NE(drawn(7), drawn(8));
}

TEST(Sampling, the_whole_is_a_sample_without_error) {
  ScriptedSource source;
  source.everyone = {count_event(EventKind::kTransform, 4)};
  const Workload w = rays_only(32 * 64);
  const auto warps = list_warps(w);
  const SamplePlan plan = plan_sample(warps, warp_costs(w, source, warps, 1), 1, 1);
  ASSERT_EQ(plan.warps.size(), warps.size());
  SimulationOptions options;
  options.warps = plan.warps;
  const SimulationResult r = simulate(w, source, one_sm(), options);
  const Estimate e = extrapolate_cycles(plan, r, one_sm());
  EXPECT_DOUBLE_EQ(e.value, static_cast<double>(r.cycles.value));
  EXPECT_DOUBLE_EQ(e.low, e.high);
}

// Simulates a sample that fills the machine, and all of `w`, and compares the cycles.
void expect_sample_within_five_percent(const Workload& w, ScriptedSource& source,
                                       const MachineConfig& config, double fraction) {
  const auto warps = list_warps(w);
  const SamplePlan plan = plan_sample(warps, warp_costs(w, source, warps, 8), fraction, 1);
  ASSERT_EQ(why_not_representative(plan, config), "");
  SimulationOptions options;
  options.warps = plan.warps;
  const Estimate e = extrapolate_cycles(plan, simulate(w, source, config, options), config);
  const auto full = static_cast<double>(cycles_of(w, source, config).value);
  EXPECT_LT(std::abs(e.value - full) / full, 0.05);
}

TEST(Sampling, a_tenth_of_equal_warps_predicts_the_whole_within_five_percent) {
  ScriptedSource source;
  source.everyone.assign(20, count_event(EventKind::kTransform, 4));
  MachineConfig config = one_sm();
  config.rt.tester(Tester::kTransform) = {2, Cycles{8}, Cycles{1}};
  const Workload w = rays_only(32 * 4000);
  expect_sample_within_five_percent(w, source, config, 0.1);
}

TEST(Sampling, the_interval_is_as_wide_as_warps_differ_beyond_their_cost) {
  MachineConfig config = one_sm();
  config.rt.tester(Tester::kTransform) = {2, Cycles{8}, Cycles{1}};
  const Workload w = rays_only(32 * 4000);
  const auto relative_width = [&](std::uint32_t most) {
    ScriptedSource source;
    for (std::uint32_t ray = 0; ray < w.rays.size(); ++ray) {
      // As many events, the cost, whatever each holds: some blocks take longer than their cost
      // says.
      const auto tests = static_cast<std::uint16_t>(1 + ray / 32 / kBlockWarps % most);
      source.script[ray].assign(5, count_event(EventKind::kTransform, tests));
    }
    const auto warps = list_warps(w);
    const SamplePlan plan = plan_sample(warps, warp_costs(w, source, warps, 8), 0.2, 1);
    SimulationOptions options;
    options.warps = plan.warps;
    const Estimate e = extrapolate_cycles(plan, simulate(w, source, config, options), config);
    const auto full = static_cast<double>(cycles_of(w, source, config).value);
    EXPECT_LT(e.low, full) << most;
    EXPECT_GT(e.high, full) << most;
    return (e.high - e.low) / e.value;
  };
  EXPECT_GT(relative_width(7), relative_width(2));
}

TEST(Sampling, a_sample_that_does_not_fill_the_machine_is_refused_with_the_remedy) {
  MachineConfig config = one_sm();
  config.sm.count = 4;  // 128 warp places
  const std::size_t warps = 100 * kBlockWarps;
  const auto why = [&](double fraction, std::uint32_t dispatches) {
    const auto plan =
        plan_sample(places(warps, dispatches), std::vector<double>(warps, 1.0), fraction, 1);
    return why_not_representative(plan, config);
  };
  EXPECT_EQ(why(0.2, 1), "");
  EXPECT_NE(why(0.05, 1).find("--sample 0.06"), std::string::npos) << why(0.05, 1);
  EXPECT_EQ(why(0.06, 1), "") << "the remedy helps";
  EXPECT_EQ(why(1, 1), "") << "the whole stands for itself";
  // Every dispatch is drained on its own, so each has to fill the machine.
  EXPECT_NE(why(0.2, 20).find("larger picture"), std::string::npos) << why(0.2, 20);
}

TEST(Sampling, dispatches_are_scaled_one_by_one) {
  ScriptedSource source;
  source.everyone.assign(20, count_event(EventKind::kTransform, 4));
  MachineConfig config = one_sm();
  config.rt.tester(Tester::kTransform) = {2, Cycles{8}, Cycles{1}};
  Workload w = rays_only(32 * 800);
  w.dispatches.push_back(w.dispatches[0]);
  w.dispatches[1].first_ray = w.rays.size();
  for (std::size_t i = 0, n = w.rays.size(); i < n; ++i) {
    w.rays.push_back(w.rays[i]);
    w.rays.back().dispatch = 1;
  }
  w.driver_hits.resize(w.rays.size());
  w.candidate_first.assign(w.rays.size() + 1, 0);
  expect_sample_within_five_percent(w, source, config, 0.15);
}

TEST(Sampling, a_fraction_outside_its_range_is_a_user_error) {
  EXPECT_THROW(plan_sample(places(1), {1.0}, 0, 1), UserError);
  EXPECT_THROW(plan_sample(places(1), {1.0}, 1.5, 1), UserError);
}

}  // namespace
}  // namespace a2rt::timing::test
