#include "a2rt/timing/sampling.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace a2rt::timing {
namespace {

constexpr std::size_t kMostStrata = 16;

// SplitMix64: small, fixed for ever, the same on every platform.
std::uint64_t next_random(std::uint64_t& state) {
  state += 0x9e3779b97f4a7c15u;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

}  // namespace

std::vector<double> warp_costs(const Workload& workload, RaySource& source,
                               const std::vector<WarpPlace>& warps, std::uint32_t lane_step) {
  std::vector<double> costs;
  costs.reserve(warps.size());
  std::vector<Event> events;
  std::uint64_t ray = 0;
  std::uint32_t dispatch = kNone;
  for (const WarpPlace& place : warps) {
    const Dispatch& d = workload.dispatches[place.dispatch];
    if (place.dispatch != dispatch) {
      dispatch = place.dispatch;
      ray = d.first_ray;
    }
    const std::uint64_t end = d.first_ray + d.ray_count;
    double cost = 1;  // a warp without rays still costs its launch
    for (; ray < end && workload.rays[ray].launch < place.first_launch + place.count; ++ray) {
      if ((workload.rays[ray].launch - place.first_launch) % lane_step == 0) {
        events.clear();
        source.events(static_cast<std::uint32_t>(ray), events);
        cost += static_cast<double>(events.size());
      }
    }
    costs.push_back(cost);
  }
  return costs;
}

SamplePlan plan_sample(const std::vector<double>& costs, double fraction, std::uint64_t seed) {
  if (!(fraction > 0 && fraction <= 1)) {
    throw UserError("--sample takes a fraction above 0 and at most 1");
  }
  SamplePlan plan;
  plan.cost = costs;
  plan.cost_all = std::accumulate(costs.begin(), costs.end(), 0.0);
  std::vector<std::uint32_t> order(costs.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return costs[a] < costs[b]; });
  // Enough warps per stratum that its spread can be estimated from at least two draws.
  const auto wanted =
      static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(costs.size())));
  const std::size_t strata = std::clamp<std::size_t>(wanted / 2, 1, kMostStrata);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> chosen;  // warp, stratum
  std::size_t at = 0;
  double cost_so_far = 0;
  for (std::size_t s = 0; s < strata && at < order.size(); ++s) {
    const double stop = plan.cost_all * static_cast<double>(s + 1) / static_cast<double>(strata);
    const std::size_t first = at;
    while (at < order.size() && (at == first || s + 1 == strata || cost_so_far < stop)) {
      cost_so_far += costs[order[at++]];
    }
    const std::size_t size = at - first;
    const auto draws = std::clamp<std::size_t>(
        static_cast<std::size_t>(std::lround(fraction * static_cast<double>(size))),
        std::min<std::size_t>(2, size), size);
    for (std::size_t i = 0; i < draws; ++i) {
      const std::size_t pick = first + i + next_random(seed) % (size - i);
      std::swap(order[first + i], order[pick]);
      chosen.emplace_back(order[first + i], static_cast<std::uint32_t>(plan.stratum_size.size()));
    }
    plan.stratum_size.push_back(size);
  }
  std::sort(chosen.begin(), chosen.end());
  for (const auto& [warp, stratum] : chosen) {
    plan.warps.push_back(warp);
    plan.stratum.push_back(stratum);
    plan.cost_chosen += costs[warp];
  }
  return plan;
}

Estimate extrapolate_cycles(const SamplePlan& plan, const SimulationResult& subset) {
  // Total warp residence of the population, by stratum, as a ratio estimate on the cost proxy.
  struct Stratum {
    double residence = 0, cost = 0, squares = 0, count = 0;
  };
  std::vector<Stratum> strata(plan.stratum_size.size());
  for (std::size_t i = 0; i < plan.warps.size(); ++i) {
    Stratum& s = strata[plan.stratum[i]];
    s.residence += static_cast<double>(subset.warps.at(i).residence.value);
    s.cost += plan.cost[plan.warps[i]];
    s.count += 1;
  }
  double ratio_all = 0, chosen_residence = 0;
  for (const Stratum& s : strata) {
    chosen_residence += s.residence;
  }
  ratio_all = chosen_residence / plan.cost_chosen;
  for (std::size_t i = 0; i < plan.warps.size(); ++i) {
    const double deviation = static_cast<double>(subset.warps.at(i).residence.value) -
                             ratio_all * plan.cost[plan.warps[i]];
    strata[plan.stratum[i]].squares += deviation * deviation;
  }
  double variance = 0;
  for (std::size_t s = 0; s < strata.size(); ++s) {
    const double size = static_cast<double>(plan.stratum_size[s]);
    if (strata[s].count > 1 && size > strata[s].count) {
      variance += size * size * (1 - strata[s].count / size) * strata[s].squares /
                  (strata[s].count * (strata[s].count - 1));
    }
  }
  const double population = ratio_all * plan.cost_all;
  const double relative = population > 0 ? std::sqrt(variance) / population : 0;
  const double full = static_cast<double>(subset.last_launch.value);
  const double tail = static_cast<double>(subset.cycles.value) - full;
  // The warps resident when the last one began are what the tail works off, in both runs.
  const double in_tail = static_cast<double>(subset.resident_then) * plan.cost_chosen /
                         static_cast<double>(plan.warps.size());
  Estimate estimate;
  if (subset.last_launch > Cycles{0} && in_tail < plan.cost_chosen) {
    estimate.value = tail + full * (plan.cost_all - in_tail) / (plan.cost_chosen - in_tail);
  } else {
    // All chosen warps fitted at once: there was no full phase to scale.
    estimate.value = static_cast<double>(subset.cycles.value) * plan.cost_all / plan.cost_chosen;
  }
  estimate.low = estimate.value * (1 - 1.96 * relative);
  estimate.high = estimate.value * (1 + 1.96 * relative);
  return estimate;
}

}  // namespace a2rt::timing
