// Sampling: representative, repeatable, and right where everything is equal.
#include "a2rt/timing/sampling.h"

#include <gtest/gtest.h>

#include <cmath>

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

TEST(Sampling, takes_the_asked_share_of_every_stratum) {
  std::vector<double> costs;
  for (int i = 0; i < 1000; ++i) {
    costs.push_back(1 + i % 100);
  }
  const SamplePlan plan = plan_sample(places(1000), costs, 0.1, 1);
  EXPECT_NEAR(static_cast<double>(plan.warps.size()), 100, 10);
  EXPECT_NEAR(plan.cost_chosen / plan.cost_all, 0.1, 0.01);
  EXPECT_TRUE(std::is_sorted(plan.warps.begin(), plan.warps.end()));
  EXPECT_EQ(std::adjacent_find(plan.warps.begin(), plan.warps.end()), plan.warps.end());
}

TEST(Sampling, the_same_seed_draws_the_same_warps_and_another_seed_does_not) {
  const std::vector<double> costs(500, 1.0);
  const auto drawn = [&](std::uint64_t seed) {
    return plan_sample(places(500), costs, 0.2, seed).warps;
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
  const Estimate e = extrapolate_cycles(plan, r);
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
  const Estimate e = extrapolate_cycles(plan, simulate(w, source, config, options));
  const auto full = static_cast<double>(cycles_of(w, source, config).value);
  EXPECT_LT(std::abs(e.value - full) / full, 0.05);
}

TEST(Sampling, a_tenth_of_equal_warps_predicts_the_whole_within_five_percent) {
  ScriptedSource source;
  source.everyone.assign(20, count_event(EventKind::kTransform, 4));
  MachineConfig config = one_sm();
  config.rt.tester(Tester::kTransform) = {2, Cycles{8}, Cycles{1}};
  const Workload w = rays_only(32 * 1000);
  expect_sample_within_five_percent(w, source, config, 0.1);
}

TEST(Sampling, a_sample_that_does_not_fill_the_machine_is_refused_with_the_remedy) {
  MachineConfig config = one_sm();  // 32 warp slots
  const std::vector<double> costs(1000, 1.0);
  const auto why = [&](double fraction, std::uint32_t dispatches) {
    return why_not_representative(plan_sample(places(1000, dispatches), costs, fraction, 1),
                                  config);
  };
  EXPECT_EQ(why(0.2, 1), "");
  EXPECT_NE(why(0.05, 1).find("--sample 0.1"), std::string::npos) << why(0.05, 1);
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
