#include "a2rt/timing/sampling.h"

#include <algorithm>
#include <cmath>
#include <map>
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

SamplePlan plan_sample(const std::vector<WarpPlace>& warps, const std::vector<double>& costs,
                       double fraction, std::uint64_t seed) {
  A2RT_CHECK(warps.size() == costs.size(), "every warp has a cost");
  if (!(fraction > 0 && fraction <= 1)) {
    throw UserError("--sample takes a fraction above 0 and at most 1");
  }
  SamplePlan plan;
  plan.cost = costs;
  for (const WarpPlace& warp : warps) {
    plan.dispatch.push_back(warp.dispatch);
  }
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

std::string why_not_representative(const SamplePlan& plan, const MachineConfig& machine) {
  if (plan.warps.size() == plan.cost.size()) {
    return {};
  }
  const std::uint64_t slots = std::uint64_t{machine.sm.count} * machine.sm.warps;
  std::map<std::uint32_t, std::pair<std::uint64_t, std::uint64_t>> warps;  // all, chosen
  for (const std::uint32_t dispatch : plan.dispatch) {
    ++warps[dispatch].first;
  }
  for (const std::uint32_t warp : plan.warps) {
    ++warps[plan.dispatch[warp]].second;
  }
  for (const auto& [dispatch, counts] : warps) {
    const auto [all, chosen] = counts;
    const std::uint64_t needed = kFillings * slots;
    if (chosen < needed) {
      const std::string of = std::to_string(chosen) + " of " + std::to_string(all) +
                             " warps of dispatch " + std::to_string(dispatch);
      return "a sample of " + of + " does not fill the machine's " + std::to_string(slots) +
             " warp slots " + std::to_string(kFillings) +
             " times over, so it has no steady state; " +
             (all > needed ? "sample at least " + std::to_string(needed) + " warps (--sample " +
                                 std::to_string(std::ceil(100.0 * static_cast<double>(needed) /
                                                          static_cast<double>(all)) /
                                                100.0)
                                     .substr(0, 4) +
                                 ")"
                           : std::string("capture a larger picture or run all warps"));
    }
  }
  return {};
}

namespace {

// One dispatch: how much of the work was done while warps could replace each other.
double extrapolate_dispatch(const DispatchTime& time, double cost_all, double cost_chosen) {
  const auto full = static_cast<double>(time.last_launch.value);
  const double tail = static_cast<double>(time.cycles.value) - full;
  // The warps resident when the last one began are what the tail works off, in both runs.
  const double in_tail = static_cast<double>(time.resident_then) * cost_chosen /
                         static_cast<double>(std::max<std::uint64_t>(time.warps, 1));
  if (time.last_launch > Cycles{0} && in_tail < cost_chosen) {
    return tail + full * (cost_all - in_tail) / (cost_chosen - in_tail);
  }
  // All chosen warps fitted at once: there was no full phase to scale.
  return static_cast<double>(time.cycles.value) * cost_all / cost_chosen;
}

// Half the width of the 95 % interval, relative to the value: the spread of warp residence within
// strata, as a ratio estimate on the cost proxy.
double relative_error(const SamplePlan& plan, const SimulationResult& subset) {
  struct Stratum {
    double squares = 0, count = 0;
  };
  std::vector<Stratum> strata(plan.stratum_size.size());
  double residence = 0;
  for (const WarpRecord& warp : subset.warps) {
    residence += static_cast<double>(warp.residence.value);
  }
  const double ratio = residence / plan.cost_chosen;
  for (std::size_t i = 0; i < plan.warps.size(); ++i) {
    const double deviation =
        static_cast<double>(subset.warps.at(i).residence.value) - ratio * plan.cost[plan.warps[i]];
    Stratum& s = strata[plan.stratum[i]];
    s.squares += deviation * deviation;
    s.count += 1;
  }
  double variance = 0;
  for (std::size_t s = 0; s < strata.size(); ++s) {
    const double size = static_cast<double>(plan.stratum_size[s]);
    if (strata[s].count > 1 && size > strata[s].count) {
      variance += size * size * (1 - strata[s].count / size) * strata[s].squares /
                  (strata[s].count * (strata[s].count - 1));
    }
  }
  const double population = ratio * plan.cost_all;
  return population > 0 ? 1.96 * std::sqrt(variance) / population : 0;
}

}  // namespace

Estimate extrapolate_cycles(const SamplePlan& plan, const SimulationResult& subset) {
  // Dispatches of the subset, in order, and their shares of the work.
  std::map<std::uint32_t, std::pair<double, double>> cost;  // all, chosen
  for (std::size_t w = 0; w < plan.cost.size(); ++w) {
    cost[plan.dispatch[w]].first += plan.cost[w];
  }
  for (const std::uint32_t warp : plan.warps) {
    cost[plan.dispatch[warp]].second += plan.cost[warp];
  }
  Estimate estimate;
  std::size_t next = 0;
  for (const auto& [dispatch, shares] : cost) {
    if (shares.second > 0) {
      estimate.value +=
          extrapolate_dispatch(subset.dispatches.at(next++), shares.first, shares.second);
    }
  }
  const double relative = relative_error(plan, subset);
  estimate.low = estimate.value * (1 - relative);
  estimate.high = estimate.value * (1 + relative);
  return estimate;
}

}  // namespace a2rt::timing
