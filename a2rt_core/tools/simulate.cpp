// simulate: cycles and energy of one unit on a workload.
#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "a2rt/base/text_file.h"
#include "a2rt/rt/result_json.h"
#include "a2rt/timing/compiled_rays.h"
#include "a2rt/timing/result_json.h"
#include "a2rt/timing/sampling.h"
#include "a2rt/timing/simulator.h"
#include "a2rt/timing/unit_source.h"
#include "a2rt/workload/file.h"
#include "command.h"
#include "gpu_option.h"
#include "parts_json.h"
#include "progress.h"
#include "simulate_print.h"
#include "timed_unit.h"

namespace a2rt::tools {
namespace {

struct Options {
  std::string workload, unit = "a2rt", unit_config, gpu = "table1", output, heatmap;
  std::string comparison = "same-count", energy_table, parts = "auto";
  std::vector<std::string> set;
  std::vector<std::uint32_t> frames;
  double sample = 1;
  std::uint64_t seed = 1;
  bool sample_check = false;
};

// Every eighth lane's rays are enough to rank warps by cost.
constexpr std::uint32_t kProxyLaneStep = 8;

struct Run {
  timing::SimulationResult result;
  std::optional<timing::SamplePlan> plan;
  std::optional<timing::Estimate> estimate;
  std::optional<std::uint64_t> full_cycles;
  std::string whole_because;  // why all warps were run although a sample was asked for
};

Run run(const Options& options, const Workload& workload, timing::RaySource& source,
        const timing::MachineConfig& machine, Progress& progress) {
  Run run;
  timing::SimulationOptions simulation;
  simulation.frames = options.frames;
  simulation.progress = [&](double share) { progress.show(share, "simulating " + options.unit); };
  if (options.sample < 1) {
    const auto warps = timing::list_warps(workload, options.frames);
    run.plan =
        timing::plan_sample(warps, timing::warp_costs(workload, source, warps, kProxyLaneStep),
                            options.sample, options.seed);
    run.whole_because = timing::why_not_representative(*run.plan, machine);
    if (run.whole_because.empty()) {
      simulation.warps = run.plan->warps;
    } else {
      run.plan.reset();
      std::fprintf(stderr, "a2rt-core simulate: all warps are run: %s\n",
                   run.whole_because.c_str());
    }
  }
  run.result = timing::simulate(workload, source, machine, simulation);
  if (run.plan) {
    run.estimate = timing::extrapolate_cycles(*run.plan, run.result, machine);
    if (options.sample_check) {
      simulation.warps.clear();
      run.full_cycles = timing::simulate(workload, source, machine, simulation).cycles.value;
    }
  }
  return run;
}

nlohmann::ordered_json sample_json(const Options& options, const Run& run) {
  if (!run.plan) {
    const std::uint64_t cycles = run.result.cycles.value;
    return {{"fraction", 1.0},
            {"asked", options.sample},
            {"whole_because", run.whole_because},
            {"warps", run.result.warps.size()},
            {"warps_of", run.result.warps.size()},
            {"cycles", cycles},
            {"cycles_low", cycles},
            {"cycles_high", cycles},
            {"confidence", 0.95}};
  }
  nlohmann::ordered_json json = {{"fraction", options.sample},
                                 {"seed", options.seed},
                                 {"warps", run.plan->warps.size()},
                                 {"warps_of", run.plan->cost.size()},
                                 {"cost_share", run.plan->cost_chosen / run.plan->cost_all},
                                 {"cycles", run.estimate->value},
                                 {"cycles_low", run.estimate->low},
                                 {"cycles_high", run.estimate->high},
                                 {"confidence", 0.95}};
  if (run.full_cycles) {
    const auto full = static_cast<double>(*run.full_cycles);
    json["full_cycles"] = *run.full_cycles;
    json["error"] = (run.estimate->value - full) / full;
  }
  return json;
}

// Cycles per launch id as a NumPy array: height x width, or flat for several dispatches.
std::string npy(const timing::SimulationResult& result) {
  const std::size_t pixels = std::size_t{result.width} * result.height;
  const std::string shape =
      pixels == result.launch_cycles.size()
          ? "(" + std::to_string(result.height) + ", " + std::to_string(result.width) + ")"
          : "(" + std::to_string(result.launch_cycles.size()) + ",)";
  std::string header = "{'descr': '<u4', 'fortran_order': False, 'shape': " + shape + ", }";
  header.append(63 - (10 + header.size()) % 64, ' ');
  header += '\n';
  std::string file("\x93NUMPY\x01\x00", 8);
  file += static_cast<char>(header.size() & 0xff);
  file += static_cast<char>(header.size() >> 8);
  file += header;
  file.append(reinterpret_cast<const char*>(result.launch_cycles.data()),
              result.launch_cycles.size() * sizeof(std::uint32_t));
  return file;
}

std::uint64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

// What the scripts read for the paper's Fig. 2, beside the full account in `fig2`.
void add_shares(nlohmann::ordered_json& json, const timing::SimulationResult& result,
                const StructureStats& structure) {
  const nlohmann::ordered_json fig2 = timing::fig2_json(result);
  json["time"]["shares"] = {{"rt_instructions", fig2.at("intersection_instruction_share")},
                            {"rt_time", fig2.at("execution_time_share")},
                            {"box_of_intersection", fig2.at("box_share_of_intersection_time")}};
  const double storage = static_cast<double>(structure.node_bytes + structure.triangle_bytes);
  json["memory"]["shares"] = {
      {"bvh_of_l1", fig2.at("bvh_share_of_l1_content")},
      {"bvh_of_l1_accesses", fig2.at("bvh_share_of_l1_accesses")},
      {"boxes_of_bvh_storage",
       storage > 0 ? static_cast<double>(structure.box_bytes) / storage : 0}};
  json["fig2"] = fig2;
}

int simulate(const Options& options) {
  const SplitSettings settings = split_settings(options.set);
  const TimedUnit timed(options.unit, options.unit_config, settings.unit, options.energy_table);
  const GpuChoice gpu = choose_gpu(options.gpu, settings.gpu);
  ReadOptions read;
  read.driver_nodes = false;
  const Workload workload = read_workload(options.workload, read);
  RtUnit& unit = timed.unit();
  const energy::Comparison comparison = energy::comparison_of(options.comparison);
  const Parts called_for = parts_called_for(workload);
  const Parts parts = options.parts == "all" ? Parts::all() : called_for;
  timing::MachineConfig machine = gpu.machine;
  const energy::TesterArea area = timed.equip(machine, comparison, parts);
  Run done;
  {
    Progress progress;
    progress.show(0, "building " + unit.info().name);
    unit.build(workload);
    timing::UnitSource source(unit, workload);
    timing::RepeatedRays repeated(source, workload.rays.size());
    const bool twice = options.sample_check && options.sample < 1;
    done = run(options, workload, twice ? static_cast<timing::RaySource&>(repeated) : source,
               machine, progress);
  }
  const timing::SimulationResult& result = done.result;
  const energy::Ledger ledger = timed.ledger(result, machine);
  print_simulation(unit.info().title, result, machine, ledger, done.estimate);
  if (!options.heatmap.empty()) {
    write_text_file(options.heatmap, npy(result));
  }
  if (options.output.empty()) {
    return 0;
  }
  nlohmann::ordered_json json;
  json["schema"] = 1;
  json["workload"] = rt::workload_json(workload, options.workload);
  json["unit"] = rt::unit_json(unit.info());
  json["gpu"] = {{"name", machine.name},
                 {"core_mhz", machine.core_mhz},
                 {"sms", machine.sm.count},
                 {"comparison", energy::comparison_name(comparison)}};
  json["config"] = timed.config_json(gpu, machine);
  json["parts"] = parts_json(called_for, parts);
  json["structure"] = rt::structure_json(unit.structure());
  json["events"] = timing::events_json(result);
  json["memory"] = timing::memory_json(result);
  json["time"] = timing::time_json(result, machine);
  json["area"] = timed.area_json(area);
  json["energy"] = energy::ledger_json(ledger);
  add_shares(json, result, unit.structure());
  if (options.sample < 1) {
    json["sample"] = sample_json(options, done);
  }
  if (!options.heatmap.empty()) {
    json["heatmap"] = options.heatmap;
  }
  json["provenance"] = {
      {"tool", "a2rt-core simulate"},
      {"seconds", result.host_seconds},
      {"rays_per_second", static_cast<double>(result.rays()) / result.host_seconds},
      {"peak_bytes", peak_bytes()}};
  write_text_file(options.output, json.dump(2) + "\n");
  return 0;
}

const RegisterCommand kCommand(
    "simulate", "Cycles, memory traffic and energy of a unit on a workload",
    "  a2rt-core simulate w.h5 --unit a2rt -o r.json\n"
    "  a2rt-core simulate w.h5 --unit baseline --compare-counts same-area --gpu mobile\n"
    "  a2rt-core simulate w.h5 --unit aqb8 --set rt.context=refetch --set artifact=true\n"
    "  a2rt-core simulate w.h5 --unit a2rt --sample 0.1 --heatmap cycles.npy\n",
    [](cli::Options& app) {
      auto options = std::make_shared<Options>();
      app.add("workload", options->workload, "Workload file").required();
      app.add("--unit", options->unit, "Unit: a name, or a .toml file of parameters");
      app.add("--unit-config", options->unit_config, "Take the unit's parameters from this file");
      app.add("--gpu", options->gpu, "Machine: a name, or a .toml file");
      app.add("--set", options->set,
              "Parameter of the machine (sm., l1., l2., dram., rt.) or of the unit")
          .one_value_each();
      app.add("--compare-counts", options->comparison,
              "Box testers: same-count, same-area (both against the A2RT engine), or config")
          .check(cli::one_of({"config", "same-count", "same-area"}));
      app.add("--parts", options->parts,
              "Parts of the RT unit that are there: auto (what the workload calls for) or all")
          .check(cli::one_of({"auto", "all"}));
      app.add("--frames", options->frames, "Only these frames").delimiter(',');
      app.add("--sample", options->sample, "Simulate this share of the warps and extrapolate")
          .check(cli::in_range(0.0001, 1.0));
      app.add("--seed", options->seed, "Of the sample");
      app.flag("--sample-check", options->sample_check,
               "Also run all warps and report the sample's error");
      app.add("--energy-table", options->energy_table, "CSV of energies");
      app.add("--heatmap", options->heatmap, "NumPy file of cycles per launch id");
      app.add("-o,--output", options->output, "Result as JSON");
      return [options] { return simulate(*options); };
    });

}  // namespace
}  // namespace a2rt::tools
