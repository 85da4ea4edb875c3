// bench-simulate: how many rays a second the timing models get through, unit by unit.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "a2rt/base/text_file.h"
#include "a2rt/base/thread_clock.h"
#include "a2rt/energy/fair_testers.h"
#include "a2rt/energy/ledger.h"
#include "a2rt/timing/compiled_rays.h"
#include "a2rt/timing/simulator.h"
#include "a2rt/timing/unit_source.h"
#include "a2rt/workload/file.h"
#include "command.h"
#include "gpu_option.h"
#include "unit_option.h"

namespace a2rt::tools {
namespace {

struct Options {
  std::string workload, gpu = "table1", output;
  std::vector<std::string> units;
  std::uint32_t repeats = 1;
};

// Processor seconds of producing every ray's events, without time: the part of a simulation that
// is the unit's functional traversal.
double walk_seconds(const Workload& workload, timing::RaySource& source) {
  EventValues nobody([](const Event&) {});
  const double start = thread_seconds();
  for (std::uint32_t ray = 0; ray < workload.rays.size(); ++ray) {
    source.events(ray, nobody);
  }
  return thread_seconds() - start;
}

struct Rate {
  const char* model;
  bool traversed;  // false: the rays had been traversed and compiled by another run
  double seconds = 0;
  timing::SimulationResult result;
  double rays_per_second() const { return static_cast<double>(result.rays()) / seconds; }
};

// The fastest of some runs in one model.
Rate rate_of(timing::Model model, bool traversed, const Options& options, const Workload& workload,
             timing::RaySource& source, timing::MachineConfig machine) {
  machine.model = model;
  Rate rate{model == timing::Model::kQueued ? "queued" : "reserved", traversed, 0, {}};
  for (std::uint32_t i = 0; i < options.repeats; ++i) {
    rate.result = timing::simulate(workload, source, machine);
    const double seconds = rate.result.host_seconds;
    rate.seconds = i == 0 ? seconds : std::min(rate.seconds, seconds);
  }
  return rate;
}

std::vector<Rate> rates_of(const Options& options, const Workload& workload,
                           timing::RaySource& source, const timing::MachineConfig& machine) {
  const auto measure = [&](timing::Model model, bool traversed, timing::RaySource& from) {
    return rate_of(model, traversed, options, workload, from, machine);
  };
  std::vector<Rate> rates;
  rates.push_back(measure(timing::Model::kQueued, true, source));
  rates.push_back(measure(timing::Model::kReserved, true, source));
  timing::RepeatedRays repeated(source, workload.rays.size());
  timing::simulate(workload, repeated, machine);  // keeps the rays
  rates.push_back(measure(timing::Model::kQueued, false, repeated));
  rates.push_back(measure(timing::Model::kReserved, false, repeated));
  return rates;
}

nlohmann::ordered_json bench_unit(const Options& options, const std::string& name,
                                  const Workload& workload) {
  UnitChoice choice = choose_unit(name, "", {});
  choice.unit->build(workload);
  const auto table = energy::EnergyTable::from_file(A2RT_ENERGY_FOLDER "/12nm.csv");
  timing::MachineConfig machine = choose_gpu(options.gpu, {}).machine;
  energy::apply_comparison(energy::Comparison::kSameCount, choice.unit->info().testers,
                           energy::engine_area_um2(table), table, machine);
  timing::UnitSource source(*choice.unit, workload);
  double walk = walk_seconds(workload, source);
  for (std::uint32_t i = 1; i < options.repeats; ++i) {
    walk = std::min(walk, walk_seconds(workload, source));
  }
  const std::vector<Rate> rates = rates_of(options, workload, source, machine);
  const auto rays = static_cast<double>(rates.front().result.rays());
  const auto cycles = static_cast<double>(rates.front().result.cycles.value);
  nlohmann::ordered_json json = {{"unit", name},
                                 {"rays", rates.front().result.rays()},
                                 {"walk_seconds", walk},
                                 {"walk_rays_per_second", rays / walk}};
  std::printf("%-10s traversal alone %18.0f rays/s\n", name.c_str(), rays / walk);
  for (const Rate& rate : rates) {
    const double error = static_cast<double>(rate.result.cycles.value) / cycles - 1;
    std::printf("%-10s %-9s %-16s %7.0f rays/s  %10llu cycles (%+.1f %%)\n", "", rate.model,
                rate.traversed ? "with traversal" : "rays known", rate.rays_per_second(),
                static_cast<unsigned long long>(rate.result.cycles.value), 100 * error);
    json["runs"].push_back({{"model", rate.model},
                            {"traversed", rate.traversed},
                            {"seconds", rate.seconds},
                            {"rays_per_second", rate.rays_per_second()},
                            {"cycles", rate.result.cycles.value},
                            {"error", error},
                            {"appointments", rate.result.appointments}});
  }
  return json;
}

int bench(const Options& options) {
  ReadOptions read;
  read.driver_nodes = false;
  const Workload workload = read_workload(options.workload, read);
  nlohmann::ordered_json results = nlohmann::ordered_json::array();
  std::printf("%s: %zu rays, one thread, processor time, best of %u\n", options.workload.c_str(),
              workload.rays.size(), options.repeats);
  for (const std::string& unit : options.units) {
    results.push_back(bench_unit(options, unit, workload));
  }
  if (!options.output.empty()) {
    write_text_file(options.output, results.dump(2) + "\n");
  }
  return 0;
}

const RegisterCommand kCommand(
    "bench-simulate",
    "Rays per second of both timing models, for every unit; rays traversed, or known from another "
    "run",
    "  a2rt-core bench-simulate w.h5\n"
    "  a2rt-core bench-simulate w.h5 --units baseline,aqb8,a2rt --repeats 3 -o rates.json\n",
    [](cli::Options& app) {
      auto options = std::make_shared<Options>();
      options->units = {"baseline", "aqb8", "a2rt", "cwbvh", "clbvh"};
      app.add("workload", options->workload, "Workload file").required();
      app.add("--units", options->units, "Units: names, or .toml files").delimiter(',');
      app.add("--gpu", options->gpu, "Machine: a name, or a .toml file");
      app.add("--repeats", options->repeats, "Runs of each unit; the fastest counts");
      app.add("-o,--output", options->output, "Result as JSON");
      return [options] { return bench(*options); };
    });

}  // namespace
}  // namespace a2rt::tools
