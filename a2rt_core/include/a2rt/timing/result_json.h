// Results as JSON: the keys `time`, `memory`, `events`, `machine` of the project's result object.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "a2rt/timing/machine_config.h"
#include "a2rt/timing/result.h"

namespace a2rt::timing {

nlohmann::ordered_json time_json(const SimulationResult& result, const MachineConfig& config);
nlohmann::ordered_json memory_json(const SimulationResult& result);
nlohmann::ordered_json events_json(const SimulationResult& result);
// The shares of the paper's Fig. 2 and how each is formed here.
nlohmann::ordered_json fig2_json(const SimulationResult& result);
const char* traffic_name(Traffic kind);
const char* event_name(EventKind kind);

}  // namespace a2rt::timing
