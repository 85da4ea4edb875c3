// Runs a workload's dispatches on the machine.
//
// A run is one host thread without shared state: the same workload and configuration give the same
// cycles on every host, alone or beside other runs.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "a2rt/timing/machine_config.h"
#include "a2rt/timing/ray_source.h"
#include "a2rt/timing/result.h"
#include "a2rt/workload/workload.h"

namespace a2rt::timing {

struct SimulationOptions {
  // Warps to run in this order, dispatch by dispatch, numbered through all of them; empty = all.
  std::vector<std::uint32_t> warps;
  // Only dispatches of these frames; empty = all.
  std::vector<std::uint32_t> frames;
  // How far the machine's parts run alone; 0 = as far as they can. It matters to the host, and to
  // who goes first of those that reach an L2 slice in one cycle from several SMs.
  Cycles stretch;
  // Called now and then with the share of warps done.
  std::function<void(double)> progress;
};

// One warp of a workload: 32 consecutive launch ids in x.
struct WarpPlace {
  std::uint32_t dispatch = 0, first_launch = 0, count = 0;
};
// All warps of the workload in launch order; their positions are the warp numbers.
std::vector<WarpPlace> list_warps(const Workload& workload,
                                  const std::vector<std::uint32_t>& frames = {});

// Throws UserError if configuration and workload do not fit, InternalError if the model breaks one
// of its own laws: an unanswered request, a count that does not add up, no progress.
SimulationResult simulate(const Workload& workload, RaySource& source, const MachineConfig& config,
                          const SimulationOptions& options = {});

}  // namespace a2rt::timing
