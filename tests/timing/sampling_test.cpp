// Sampling: representative, repeatable, and right where everything is equal.
#include "a2rt/timing/sampling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mocks.h"

namespace a2rt::timing::test {
namespace {

TEST(Sampling, takes_the_asked_share_of_every_stratum) {
  std::vector<double> costs;
  for (int i = 0; i < 1000; ++i) {
    costs.push_back(1 + i % 100);
  }
  const SamplePlan plan = plan_sample(costs, 0.1, 1);
  EXPECT_NEAR(static_cast<double>(plan.warps.size()), 100, 10);
  EXPECT_NEAR(plan.cost_chosen / plan.cost_all, 0.1, 0.01);
  EXPECT_TRUE(std::is_sorted(plan.warps.begin(), plan.warps.end()));
  EXPECT_EQ(std::adjacent_find(plan.warps.begin(), plan.warps.end()), plan.warps.end());
}

TEST(Sampling, the_same_seed_draws_the_same_warps_and_another_seed_does_not) {
  const std::vector<double> costs(500, 1.0);
  EXPECT_EQ(plan_sample(costs, 0.2, 7).warps, plan_sample(costs, 0.2, 7).warps);
  EXPECT_NE(plan_sample(costs, 0.2, 7).warps, plan_sample(costs, 0.2, 8).warps);
}

TEST(Sampling, the_whole_is_a_sample_without_error) {
  ScriptedSource source;
  source.everyone = {count_event(EventKind::kTransform, 4)};
  const Workload w = rays_only(32 * 64);
  const auto places = list_warps(w);
  const SamplePlan plan = plan_sample(warp_costs(w, source, places, 1), 1, 1);
  ASSERT_EQ(plan.warps.size(), places.size());
  SimulationOptions options;
  options.warps = plan.warps;
  const SimulationResult r = simulate(w, source, one_sm(), options);
  const Estimate e = extrapolate_cycles(plan, r);
  EXPECT_DOUBLE_EQ(e.value, static_cast<double>(r.cycles.value));
  EXPECT_DOUBLE_EQ(e.low, e.high);
}

TEST(Sampling, a_tenth_of_equal_warps_predicts_the_whole_within_five_percent) {
  ScriptedSource source;
  source.everyone.assign(20, count_event(EventKind::kTransform, 4));
  MachineConfig config = one_sm();
  config.rt.tester(Tester::kTransform) = {2, Cycles{8}, Cycles{1}};
  const Workload w = rays_only(32 * 1000);
  const SamplePlan plan = plan_sample(warp_costs(w, source, list_warps(w), 8), 0.1, 1);
  SimulationOptions options;
  options.warps = plan.warps;
  const Estimate e = extrapolate_cycles(plan, simulate(w, source, config, options));
  const auto full = static_cast<double>(cycles_of(w, source, config).value);
  EXPECT_LT(std::abs(e.value - full) / full, 0.05);
}

TEST(Sampling, a_fraction_outside_its_range_is_a_user_error) {
  EXPECT_THROW(plan_sample({1.0}, 0, 1), UserError);
  EXPECT_THROW(plan_sample({1.0}, 1.5, 1), UserError);
}

}  // namespace
}  // namespace a2rt::timing::test
