// Sampling: time a representative subset of the warps and extrapolate.
//
// Warps are sorted by a cost proxy (events of some of their rays, traced without time), cut into
// strata of equal cost, and drawn from each stratum by a fixed pseudo-random sequence. The subset
// runs on the whole machine. In each dispatch the time up to the launch of the last warp is scaled
// by the ratio of the work done in it; the tail that works off the then resident warps is the same
// in both runs. That needs a time in which the machine is full and warps replace each other: a
// sample that does not provide it says nothing about the whole and is refused.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/timing/ray_source.h"
#include "a2rt/timing/result.h"
#include "a2rt/timing/simulator.h"
#include "a2rt/workload/workload.h"

namespace a2rt::timing {

struct SamplePlan {
  std::vector<std::uint32_t> warps;         // chosen, ascending
  std::vector<std::uint32_t> stratum;       // of each chosen warp
  std::vector<std::uint64_t> stratum_size;  // warps in each stratum
  std::vector<double> cost;                 // proxy of every warp
  std::vector<std::uint32_t> dispatch;      // of every warp
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

// Cycles of the whole run from those of the subset. The interval covers the sampling of warps; it
// does not cover what a sparser run changes in the caches, which `--sample-check` measures.
Estimate extrapolate_cycles(const SamplePlan& plan, const SimulationResult& subset);

}  // namespace a2rt::timing
