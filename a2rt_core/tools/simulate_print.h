// The table that `simulate` prints.
#pragma once

#include <optional>
#include <string>

#include "a2rt/energy/fair_testers.h"
#include "a2rt/energy/ledger.h"
#include "a2rt/timing/machine_config.h"
#include "a2rt/timing/result.h"
#include "a2rt/timing/sampling.h"

namespace a2rt::tools {

void print_simulation(const std::string& title, const timing::SimulationResult& result,
                      const timing::MachineConfig& machine, const energy::Ledger& ledger,
                      const std::optional<timing::Estimate>& estimate);

}  // namespace a2rt::tools
