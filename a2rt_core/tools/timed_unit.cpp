#include "timed_unit.h"

#include <nlohmann/json.hpp>

#include "a2rt/energy/qbox_area.h"
#include "a2rt/rt/a2rt_precision.h"
#include "a2rt/rt/result_json.h"

namespace a2rt::tools {
namespace {

// The table as the testers of an A2RT of this precision cost.
energy::EnergyTable a2rt_table(const energy::EnergyTable& table, const UnitChoice& choice) {
  const arith::OriginDesign origin = rt::default_origin(choice.unit->info().name);
  return energy::for_precision(table, rt::read_a2rt_precision(choice.section, origin));
}

}  // namespace

TimedUnit::TimedUnit(const std::string& unit, const std::string& unit_config,
                     const std::vector<std::string>& set, const std::string& energy_table)
    : choice_(choose_unit(unit, unit_config, set)),
      published_(energy::EnergyTable::from_file(
          energy_table.empty() ? A2RT_ENERGY_FOLDER "/12nm.csv" : energy_table)),
      table_(design() == energy::Design::kA2rt ? a2rt_table(published_, choice_) : published_) {}

energy::TesterArea TimedUnit::equip(timing::MachineConfig& machine, energy::Comparison comparison,
                                    const Parts& parts) const {
  // What "same area" means: the engine of the unit a2rt as configured.
  const UnitChoice yardstick = choose_unit("a2rt", "", {});
  const double um2 = energy::engine_area_um2(a2rt_table(published_, yardstick));
  const energy::TesterArea area =
      energy::apply_comparison(comparison, design(), um2, table_, machine);
  if (!parts.has(Part::kTransformUnit)) {
    machine.rt.tester(timing::Tester::kTransform).count = 0;
  }
  if (!parts.has(Part::kTriangleTester)) {
    machine.rt.tester(timing::Tester::kTriangle).count = 0;
  }
  return area;
}

energy::Ledger TimedUnit::ledger(const timing::SimulationResult& result,
                                 const timing::MachineConfig& machine) const {
  return energy::make_ledger(energy::actions_of(result, design()),
                             energy::instances_of(result, machine, design()), result.milliseconds,
                             table_);
}

nlohmann::ordered_json TimedUnit::config_json(const GpuChoice& gpu,
                                              const timing::MachineConfig& machine) const {
  nlohmann::ordered_json json = rt::config_json(choice_.section);
  for (const config::ParameterDoc& p : gpu.section.describe()) {
    json["gpu." + p.key] = p.value;
  }
  for (std::size_t t = 0; t < timing::kTesters; ++t) {
    json["gpu.rt.testers." + std::string(timing::tester_name(static_cast<timing::Tester>(t))) +
         ".count"] = machine.rt.testers[t].count;
  }
  return json;
}

nlohmann::ordered_json TimedUnit::area_json(const energy::TesterArea& area) const {
  nlohmann::ordered_json json = {{"box_testers_um2", area.used_um2},
                                 {"reference_um2", area.reference_um2},
                                 {"reached_minimum", area.reached_minimum}};
  const bool a2rt = design() == energy::Design::kA2rt;
  if (a2rt || design() == energy::Design::kAqb8) {
    const energy::Row& qbox = table_.find(a2rt ? "qbox_a2rt" : "qbox_aqb8", "test");
    json["tester"] = {{"um2", qbox.area_um2},
                      {"pj", qbox.energy_pj},
                      {"note", energy::note_name(qbox.note)},
                      {"source", qbox.source}};
  }
  return json;
}

}  // namespace a2rt::tools
