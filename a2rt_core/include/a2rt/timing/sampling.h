// Sampling: time a representative subset of the warps and extrapolate.
//
// Each dispatch is cut into blocks of consecutive warps, which share cache lines. Of the blocks, in
// the order of their cost, every so-many-th is run, so that cheap and dear ones have their share.
// The warps launched neither in the machine's first filling nor in its last ran on a full machine.
// By Little's law such a machine gives residence / places cycles to a warp, and so long the warps
// left out would have taken, by their share of the cost (a proxy: events of some of their rays,
// traced without time). Cold start and thinning end occur once in the sample as in the whole. A
// sample that does not fill the machine a few times over has no warps between its start and its
// end; it is refused. MODEL.md says what the method rests on.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/timing/ray_source.h"
#include "a2rt/timing/result.h"
#include "a2rt/timing/simulator.h"
#include "a2rt/workload/workload.h"

namespace a2rt::timing {

// Consecutive warps drawn together. Few enough that the least sample has a dozen blocks, whose
// spread gives the interval.
inline constexpr std::size_t kBlockWarps = 64;

struct SamplePlan {
  std::vector<std::uint32_t> warps;     // chosen, ascending
  std::vector<std::uint32_t> block;     // of every warp, numbered through all dispatches
  std::vector<double> cost;             // proxy of every warp
  std::vector<std::uint32_t> dispatch;  // of every warp
  double cost_all = 0, cost_chosen = 0;
};

struct Estimate {
  double value = 0;
  double low = 0, high = 0;  // 95 % confidence
};

// Proxy of every warp: events of every `lane_step`-th lane's rays.
std::vector<double> warp_costs(const Workload& workload, RaySource& source,
                               const std::vector<WarpPlace>& warps, std::uint32_t lane_step);

// `costs` of `warps`, both in launch order. Throws UserError unless 0 < fraction <= 1. The same
// arguments give the same plan.
SamplePlan plan_sample(const std::vector<WarpPlace>& warps, const std::vector<double>& costs,
                       double fraction, std::uint64_t seed);

// Why the plan cannot stand for the whole on this machine, and what to do about it; empty if it
// can. Every dispatch needs `kFillings` times as many sampled warps as the machine holds.
inline constexpr std::uint64_t kFillings = 3;
std::string why_not_representative(const SamplePlan& plan, const MachineConfig& machine);

// Cycles of the whole run from those of the subset, simulated on `machine`. The interval comes from
// the spread between blocks and from the share of the sample's time in which warp places stood
// empty: the shorter a run, the less of it is like the whole, whose caches are warm.
Estimate extrapolate_cycles(const SamplePlan& plan, const SimulationResult& subset,
                            const MachineConfig& machine);

}  // namespace a2rt::timing
