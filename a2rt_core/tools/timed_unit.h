// A unit together with all that simulations of it share: its table of energies, and how many
// testers a machine gets.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "a2rt/config/section.h"
#include "a2rt/energy/fair_testers.h"
#include "a2rt/energy/ledger.h"
#include "a2rt/timing/machine_config.h"
#include "a2rt/timing/result.h"
#include "a2rt/workload/parts.h"
#include "gpu_option.h"
#include "unit_option.h"

namespace a2rt::tools {

class TimedUnit {
 public:
  // `energy_table`: a CSV file; empty: the 12 nm one. The others as in choose_unit().
  TimedUnit(const std::string& unit, const std::string& unit_config,
            const std::vector<std::string>& set, const std::string& energy_table);

  RtUnit& unit() const { return *choice_.unit; }
  energy::Design design() const { return unit().info().testers; }
  // Gives the machine its box testers, and takes away the testers that `parts` leaves out.
  energy::TesterArea equip(timing::MachineConfig& machine, energy::Comparison comparison,
                           const Parts& parts) const;
  energy::Ledger ledger(const timing::SimulationResult& result,
                        const timing::MachineConfig& machine) const;
  // For results: every parameter of unit and machine, and what equip() returned.
  nlohmann::ordered_json config_json(const GpuChoice& gpu,
                                     const timing::MachineConfig& machine) const;
  nlohmann::ordered_json area_json(const energy::TesterArea& area) const;

 private:
  UnitChoice choice_;
  energy::EnergyTable published_;
  energy::EnergyTable table_;  // with the testers of this unit's precision
};

}  // namespace a2rt::tools
