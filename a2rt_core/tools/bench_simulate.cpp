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
  double seconds = 0;
  timing::SimulationResult result;
  double rays_per_second() const { return static_cast<double>(result.rays()) / seconds; }
};

// The fastest of some runs in one model.
Rate rate_of(timing::Model model, const Options& options, const Workload& workload,
             timing::RaySource& source, timing::MachineConfig machine) {
  machine.model = model;
  Rate rate;
  for (std::uint32_t i = 0; i < options.repeats; ++i) {
    rate.result = timing::simulate(workload, source, machine);
    const double seconds = rate.result.host_seconds;
    rate.seconds = i == 0 ? seconds : std::min(rate.seconds, seconds);
  }
  return rate;
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
  const Rate queued = rate_of(timing::Model::kQueued, options, workload, source, machine);
  const Rate reserved = rate_of(timing::Model::kReserved, options, workload, source, machine);
  const auto rays = static_cast<double>(queued.result.rays());
  const double error = static_cast<double>(reserved.result.cycles.value) /
                           static_cast<double>(queued.result.cycles.value) -
                       1;
  std::printf(
      "%-13s %9.0f rays/s simulated, of it the walk alone %9.0f rays/s (%2.0f %%)  %llu cycles\n"
      "%-13s %9.0f rays/s with model = \"reserved\", %.2fx  %llu cycles (%+.1f %%)\n",
      name.c_str(), queued.rays_per_second(), rays / walk, 100 * walk / queued.seconds,
      static_cast<unsigned long long>(queued.result.cycles.value), "", reserved.rays_per_second(),
      queued.seconds / reserved.seconds,
      static_cast<unsigned long long>(reserved.result.cycles.value), 100 * error);
  return {{"unit", name},
          {"rays", queued.result.rays()},
          {"seconds", queued.seconds},
          {"rays_per_second", queued.rays_per_second()},
          {"walk_seconds", walk},
          {"walk_rays_per_second", rays / walk},
          {"cycles", queued.result.cycles.value},
          {"appointments", queued.result.appointments},
          {"reserved",
           {{"seconds", reserved.seconds},
            {"rays_per_second", reserved.rays_per_second()},
            {"cycles", reserved.result.cycles.value},
            {"error", error}}}};
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
    "bench-simulate", "Rays per second of both timing models, for every unit",
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
