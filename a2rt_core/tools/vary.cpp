// vary: one unit on many machines. Its rays are traversed once and timed on each.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/base/text_file.h"
#include "a2rt/rt/result_json.h"
#include "a2rt/timing/compiled_rays.h"
#include "a2rt/timing/result_json.h"
#include "a2rt/timing/simulator.h"
#include "a2rt/timing/unit_source.h"
#include "a2rt/workload/file.h"
#include "command.h"
#include "gpu_option.h"
#include "parts_json.h"
#include "progress.h"
#include "timed_unit.h"

namespace a2rt::tools {
namespace {

struct Options {
  std::string workload, unit = "a2rt", unit_config, gpu = "table1", output;
  std::string comparison = "same-count", energy_table;
  std::vector<std::string> set, vary;
};

class NoRays final : public timing::RaySource {
 public:
  void events(std::uint32_t, EventReceiver&) override {}
};

struct Parameter {
  std::string key;
  std::vector<std::string> values;
};

Parameter read_parameter(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size()) {
    throw UserError("--vary " + text + " does not say what to vary; write KEY=VALUE,VALUE,...");
  }
  Parameter parameter{text.substr(0, equals), {}};
  for (std::size_t at = equals + 1; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    if (comma == at) {
      throw UserError("--vary " + text + " has an empty value");
    }
    parameter.values.push_back(text.substr(at, comma - at));
    at = comma + 1;
  }
  if (!split_settings({text}).unit.empty()) {
    throw UserError("--vary " + parameter.key +
                    " is no parameter of the machine; one of the unit changes what its rays do: "
                    "simulate each value with --set");
  }
  return parameter;
}

// A value of each parameter; the last one changes fastest.
std::vector<std::vector<std::string>> combinations(const std::vector<Parameter>& parameters) {
  std::vector<std::vector<std::string>> all = {{}};
  for (const Parameter& p : parameters) {
    std::vector<std::vector<std::string>> longer;
    for (const std::vector<std::string>& values : all) {
      for (const std::string& value : p.values) {
        longer.push_back(values);
        longer.back().push_back(value);
      }
    }
    all = std::move(longer);
  }
  return all;
}

struct Variant {
  std::vector<std::string> values;
  GpuChoice gpu;
  timing::MachineConfig machine;  // with the testers that the unit gets
  energy::TesterArea area;
};

// A count that something else decides would make rows that differ in name only.
void check_counts(const Variant& variant, const std::vector<Parameter>& parameters) {
  for (const Parameter& p : parameters) {
    for (std::size_t t = 0; t < timing::kTesters; ++t) {
      const std::string name = timing::tester_name(static_cast<timing::Tester>(t));
      if (p.key == "rt.testers." + name + ".count" &&
          variant.machine.rt.testers[t].count != variant.gpu.machine.rt.testers[t].count) {
        throw UserError("--vary " + p.key +
                        " has no effect: the comparison, or what the workload calls for, decides "
                        "this count; use --compare-counts config (a2rt: --counts config)");
      }
    }
  }
}

// All of them, so that what is misspelt or does not fit is found before the first one runs.
std::vector<Variant> variants_of(const Options& options, const std::vector<std::string>& fixed,
                                 const std::vector<Parameter>& parameters, const TimedUnit& timed,
                                 const Parts& parts) {
  std::vector<Variant> variants;
  for (const std::vector<std::string>& values : combinations(parameters)) {
    std::vector<std::string> settings = fixed;
    for (std::size_t i = 0; i < values.size(); ++i) {
      settings.push_back(parameters[i].key + "=" + values[i]);
    }
    Variant variant{values, choose_gpu(options.gpu, settings), {}, {}};
    variant.machine = variant.gpu.machine;
    variant.area = timed.equip(variant.machine, energy::comparison_of(options.comparison), parts);
    check_counts(variant, parameters);
    const Workload nothing;
    NoRays none;
    timing::simulate(nothing, none, variant.machine);  // refuses a machine that cannot be
    variants.push_back(std::move(variant));
  }
  return variants;
}

void print_heading(const std::vector<Parameter>& parameters) {
  for (const Parameter& p : parameters) {
    std::printf("%16s ", p.key.c_str());
  }
  std::printf("%12s %9s %10s %10s\n", "cycles", "speedup", "mJ", "rays/s");
}

nlohmann::ordered_json run(const Workload& workload, timing::RaySource& source,
                           const TimedUnit& timed, const std::vector<Parameter>& parameters,
                           const Variant& variant, std::uint64_t& first_cycles) {
  const timing::SimulationResult result = timing::simulate(workload, source, variant.machine);
  const energy::Ledger ledger = timed.ledger(result, variant.machine);
  const std::uint64_t cycles = result.cycles.value;
  first_cycles = first_cycles == 0 ? cycles : first_cycles;
  const double speedup = static_cast<double>(first_cycles) / static_cast<double>(cycles);
  const double rate = static_cast<double>(result.rays()) / result.host_seconds;
  nlohmann::ordered_json set;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    std::printf("%16s ", variant.values[i].c_str());
    set[parameters[i].key] = variant.values[i];
  }
  std::printf("%12llu %8.3fx %10.4f %10.0f\n", static_cast<unsigned long long>(cycles), speedup,
              ledger.total_pj() * 1e-9, rate);
  std::fflush(stdout);
  return {{"set", set},
          {"config", timed.config_json(variant.gpu, variant.machine)},
          {"area", timed.area_json(variant.area)},
          {"speedup", speedup},
          {"time", timing::time_json(result, variant.machine)},
          {"memory", timing::memory_json(result)},
          {"energy", energy::ledger_json(ledger)},
          {"seconds", result.host_seconds},
          {"rays_per_second", rate}};
}

int vary(const Options& options) {
  const SplitSettings settings = split_settings(options.set);
  std::vector<Parameter> parameters;
  for (const std::string& text : options.vary) {
    parameters.push_back(read_parameter(text));
  }
  const TimedUnit timed(options.unit, options.unit_config, settings.unit, options.energy_table);
  ReadOptions read;
  read.driver_nodes = false;
  const Workload workload = read_workload(options.workload, read);
  const Parts parts = parts_called_for(workload);
  const std::vector<Variant> variants =
      variants_of(options, settings.gpu, parameters, timed, parts);
  Progress progress;
  progress.show(0, "building " + timed.unit().info().name);
  timed.unit().build(workload);
  timing::UnitSource source(timed.unit(), workload);
  timing::RepeatedRays repeated(source, workload.rays.size());
  print_heading(parameters);
  nlohmann::ordered_json json = {{"schema", 1},
                                 {"workload", rt::workload_json(workload, options.workload)},
                                 {"unit", rt::unit_json(timed.unit().info())},
                                 {"gpu", options.gpu},
                                 {"comparison", options.comparison},
                                 {"parts", parts_json(parts, parts)}};
  std::uint64_t first_cycles = 0;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    json["runs"].push_back(run(workload, repeated, timed, parameters, variants[i], first_cycles));
    if (!options.output.empty()) {
      write_text_file(options.output, json.dump(2) + "\n");  // what is finished is not lost
    }
    progress.show(static_cast<double>(i + 1) / static_cast<double>(variants.size()),
                  "machine " + std::to_string(i + 1) + " of " + std::to_string(variants.size()));
  }
  return 0;
}

const RegisterCommand kCommand(
    "vary", "One unit on many machines: its rays are traversed once and timed on each",
    "  a2rt-core vary w.h5 --unit a2rt --vary l1.capacity=32768,65536,131072\n"
    "  a2rt-core vary w.h5 --unit aqb8 --vary rt.warps=4,8 --vary l1.latency=20,40 -o v.json\n"
    "  a2rt-core vary w.h5 --unit baseline --set model=reserved --vary dram.mhz=1750,3500\n",
    [](cli::Options& app) {
      auto options = std::make_shared<Options>();
      app.add("workload", options->workload, "Workload file").required();
      app.add("--unit", options->unit, "Unit: a name, or a .toml file of parameters");
      app.add("--unit-config", options->unit_config, "Take the unit's parameters from this file");
      app.add("--gpu", options->gpu, "Machine: a name, or a .toml file");
      app.add("--set", options->set, "Parameter of the machine or of the unit that stays")
          .one_value_each();
      app.add("--vary", options->vary,
              "KEY=VALUE,VALUE,... of the machine; several are combined in all ways. Short stack "
              "and contexts (rt.stack_*, rt.context*) first: each change has the rays traversed "
              "anew")
          .one_value_each()
          .required();
      app.add("--compare-counts", options->comparison,
              "Box testers: same-count, same-area (both against the A2RT engine), or config")
          .check(cli::one_of({"config", "same-count", "same-area"}));
      app.add("--energy-table", options->energy_table, "CSV of energies");
      app.add("-o,--output", options->output, "Results as JSON");
      return [options] { return vary(*options); };
    });

}  // namespace
}  // namespace a2rt::tools
