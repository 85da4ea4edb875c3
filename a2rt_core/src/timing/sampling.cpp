#include "a2rt/timing/sampling.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <map>
#include <numeric>

namespace a2rt::timing {
namespace {

// SplitMix64: small, fixed for ever, the same on every platform.
std::uint64_t next_random(std::uint64_t& state) {
  state += 0x9e3779b97f4a7c15u;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

// `count` of `all` blocks, evenly apart from a random start, ascending.
std::vector<std::size_t> evenly(std::size_t all, std::size_t count, std::uint64_t& random) {
  const double step = static_cast<double>(all) / static_cast<double>(count);
  const double start = step * static_cast<double>(next_random(random) >> 11) * 0x1p-53;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(start + step * static_cast<double>(i));
    out.push_back(std::min(at, all - 1));
  }
  return out;
}

// The blocks of the dispatch whose warps are [first, end), the cheapest first.
std::vector<std::size_t> by_cost(const std::vector<double>& costs, std::size_t first,
                                 std::size_t end, std::size_t blocks) {
  std::vector<double> cost(blocks, 0);
  for (std::size_t warp = first; warp < end; ++warp) {
    cost[(warp - first) / kBlockWarps] += costs[warp];
  }
  std::vector<std::size_t> order(blocks);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return cost[a] < cost[b]; });
  return order;
}

}  // namespace

std::vector<double> warp_costs(const Workload& workload, RaySource& source,
                               const std::vector<WarpPlace>& warps, std::uint32_t lane_step) {
  std::vector<double> costs;
  costs.reserve(warps.size());
  std::uint64_t ray = 0;
  std::uint32_t dispatch = kNone;
  std::uint64_t events = 0;
  EventValues counter([&events](const Event&) { ++events; });
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
        events = 0;
        source.events(static_cast<std::uint32_t>(ray), counter);
        cost += static_cast<double>(events);
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
  plan.cost_all = std::accumulate(costs.begin(), costs.end(), 0.0);
  std::uint32_t blocks_before = 0;
  for (std::size_t first = 0; first < warps.size();) {
    std::size_t end = first;
    for (; end < warps.size() && warps[end].dispatch == warps[first].dispatch; ++end) {
      plan.dispatch.push_back(warps[end].dispatch);
      plan.block.push_back(blocks_before + static_cast<std::uint32_t>((end - first) / kBlockWarps));
    }
    const std::size_t blocks = plan.block.back() + 1 - blocks_before;
    // At least the asked share, but no block more for a rounding error.
    const auto wanted =
        static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(blocks) - 1e-9));
    // A spread needs two.
    const std::size_t count = std::clamp(wanted, std::min<std::size_t>(2, blocks), blocks);
    const std::vector<std::size_t> sorted = by_cost(costs, first, end, blocks);
    for (const std::size_t rank : evenly(blocks, count, seed)) {
      const std::size_t block = sorted[rank];
      const std::size_t stop = std::min(end, first + (block + 1) * kBlockWarps);
      for (std::size_t warp = first + block * kBlockWarps; warp < stop; ++warp) {
        plan.warps.push_back(static_cast<std::uint32_t>(warp));
        plan.cost_chosen += costs[warp];
      }
    }
    blocks_before += static_cast<std::uint32_t>(blocks);
    first = end;
  }
  std::sort(plan.warps.begin(), plan.warps.end());
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

// Warps of one block, or of one dispatch.
struct Sum {
  double cost = 0;
  double residence = 0;  // cycles on the machine, summed over warps
  double warps = 0;
};

struct DispatchSample {
  double cost_all = 0, cost_chosen = 0;
  double warps_all = 0;
  double residence = 0;  // of all sampled warps
  // Of the warps that ran on a full machine: launched neither in its first filling nor in its last.
  std::map<std::uint32_t, Sum> blocks;

  Sum steady() const {
    Sum sum;
    for (const auto& [block, part] : blocks) {
      sum.cost += part.cost;
      sum.residence += part.residence;
      sum.warps += part.warps;
    }
    return sum;
  }
};

std::map<std::uint32_t, DispatchSample> by_dispatch(const SamplePlan& plan,
                                                    const SimulationResult& subset,
                                                    std::size_t places) {
  std::map<std::uint32_t, DispatchSample> out;
  for (std::size_t w = 0; w < plan.cost.size(); ++w) {
    out[plan.dispatch[w]].cost_all += plan.cost[w];
    out[plan.dispatch[w]].warps_all += 1;
  }
  std::map<std::uint32_t, std::vector<std::uint32_t>> order;  // of launches
  for (const std::uint32_t warp : plan.warps) {
    out[plan.dispatch[warp]].cost_chosen += plan.cost[warp];
    order[plan.dispatch[warp]].push_back(warp);
  }
  std::vector<bool> steady(plan.cost.size(), false);
  for (const auto& [dispatch, warps] : order) {
    for (std::size_t i = places; i + places < warps.size(); ++i) {
      steady[warps[i]] = true;
    }
  }
  for (const WarpRecord& warp : subset.warps) {
    DispatchSample& dispatch = out[plan.dispatch[warp.number]];
    dispatch.residence += static_cast<double>(warp.residence.value);
    if (steady[warp.number]) {
      Sum& block = dispatch.blocks[plan.block[warp.number]];
      block.cost += plan.cost[warp.number];
      block.residence += static_cast<double>(warp.residence.value);
      block.warps += 1;
    }
  }
  return out;
}

// Half the width of the 95 % interval of residence per cost, relative to it: a ratio estimate over
// clusters (Cochran, Sampling Techniques, section 6.3), without the part that was run anyway.
double relative_spread(const DispatchSample& sample) {
  const Sum steady = sample.steady();
  const auto n = static_cast<double>(sample.blocks.size());
  if (n < 2) {
    return 1;
  }
  double squares = 0;
  for (const auto& [block, part] : sample.blocks) {
    const double off = part.residence - part.cost * steady.residence / steady.cost;
    squares += off * off;
  }
  const double left_out = 1 - steady.warps / sample.warps_all;
  const double deviation = std::sqrt(left_out * squares / (n * (n - 1)));
  const double t = boost::math::quantile(boost::math::students_t(n - 1), 0.975);
  return t * deviation / (steady.residence / n);
}

}  // namespace

Estimate extrapolate_cycles(const SamplePlan& plan, const SimulationResult& subset,
                            const MachineConfig& machine) {
  const std::size_t places = std::size_t{machine.sm.count} * machine.sm.warps;
  Estimate estimate;
  double half_width = 0;
  std::size_t next = 0;
  for (const auto& [number, sample] : by_dispatch(plan, subset, places)) {
    if (sample.cost_chosen == 0) {
      continue;
    }
    const auto cycles = static_cast<double>(subset.dispatches.at(next++).cycles.value);
    estimate.value += cycles;
    if (sample.cost_chosen < sample.cost_all) {
      const Sum steady = sample.steady();
      // Little's law: a full machine spends residence / places cycles on a warp.
      const double rate = steady.residence / steady.cost / static_cast<double>(places);
      const double added = rate * (sample.cost_all - sample.cost_chosen);
      estimate.value += added;
      // Share of the sample's time that is not like the whole: places stood empty.
      const double empty = 1 - sample.residence / (cycles * static_cast<double>(places));
      half_width += std::hypot(relative_spread(sample), empty) * added;
    }
  }
  estimate.low = estimate.value - half_width;
  estimate.high = estimate.value + half_width;
  return estimate;
}

}  // namespace a2rt::timing
