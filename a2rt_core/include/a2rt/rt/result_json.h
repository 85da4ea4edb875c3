// Parts of the project's result object (design: one object per run) that need no time.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "a2rt/config/section.h"
#include "a2rt/rt/functional.h"
#include "a2rt/rt/unit.h"
#include "a2rt/workload/workload.h"

namespace a2rt::rt {

nlohmann::ordered_json workload_json(const Workload& workload, const std::string& file);
nlohmann::ordered_json unit_json(const UnitInfo& info);
// Every parameter read, with the value in effect.
nlohmann::ordered_json config_json(const config::Section& section);
nlohmann::ordered_json structure_json(const StructureStats& stats);
nlohmann::ordered_json events_json(const EventTotals& totals);
// What the unit asks of L1, by kind.
nlohmann::ordered_json traffic_json(const EventTotals& totals);
// `lost`: rays whose closest hit the unit lost (comparison with the driver).
nlohmann::ordered_json accuracy_json(const FunctionalResult& result, std::uint64_t lost);

}  // namespace a2rt::rt
