// The ledger: counts of a timed run times a table's energies.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "a2rt/energy/table.h"
#include "a2rt/rt/unit.h"
#include "a2rt/timing/machine_config.h"
#include "a2rt/timing/result.h"

namespace a2rt::energy {

// Whose testers run: the same event costs different hardware.
using Design = BoxTesters;

struct Action {
  std::string component, action;
  std::uint64_t count = 0;
};
struct Instances {
  std::string component;
  std::uint64_t count = 0;
};

// Every (component, action) that some run can emit; counts are 0.
std::vector<Action> possible_actions();
// What this run did; no entry has count 0.
std::vector<Action> actions_of(const timing::SimulationResult& result, Design design);
// What leaks while it runs.
std::vector<Instances> instances_of(const timing::SimulationResult& result,
                                    const timing::MachineConfig& config, Design design);

struct Entry {
  std::string component, action, source;
  Note note = Note::kEstimated;
  std::uint64_t count = 0;
  double pj = 0, low_pj = 0, high_pj = 0;
};
struct Leakage {
  std::string component;
  std::uint64_t instances = 0;
  double pj = 0;
};

struct Ledger {
  std::vector<Entry> entries;
  std::vector<Leakage> leakage;
  double milliseconds = 0;
  std::string table;
  unsigned node_nm = 0;
  double dynamic_pj() const;
  double leakage_pj() const;
  double total_pj() const { return dynamic_pj() + leakage_pj(); }
  double low_pj() const;  // every action at its low value, leakage as it is
  double high_pj() const;
};

// Throws UserError naming every action or component the table lacks.
Ledger make_ledger(const std::vector<Action>& actions, const std::vector<Instances>& instances,
                   double milliseconds, const EnergyTable& table);
nlohmann::ordered_json ledger_json(const Ledger& ledger);

}  // namespace a2rt::energy
