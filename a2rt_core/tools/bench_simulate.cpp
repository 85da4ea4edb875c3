// bench-simulate: how many rays a second the timing model gets through, unit by unit.
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

nlohmann::ordered_json bench_unit(const Options& options, const std::string& name,
                                  const Workload& workload) {
  UnitChoice choice = choose_unit(name, "", {});
  choice.unit->build(workload);
  const auto table = energy::EnergyTable::from_file(A2RT_ENERGY_FOLDER "/12nm.csv");
  timing::MachineConfig machine = choose_gpu(options.gpu, {}).machine;
  energy::apply_comparison(energy::Comparison::kSameCount, choice.unit->info().testers,
                           energy::engine_area_um2(table), table, machine);
  timing::UnitSource source(*choice.unit, workload);
  double walk = 0, all = 0;
  timing::SimulationResult result;
  for (std::uint32_t i = 0; i < options.repeats; ++i) {
    const double walked = walk_seconds(workload, source);
    result = timing::simulate(workload, source, machine);
    walk = i == 0 ? walked : std::min(walk, walked);
    all = i == 0 ? result.host_seconds : std::min(all, result.host_seconds);
  }
  const auto rays = static_cast<double>(result.rays());
  std::printf(
      "%-13s %9.0f rays/s simulated, of it the walk alone %9.0f rays/s (%2.0f %%)  %llu cycles\n",
      name.c_str(), rays / all, rays / walk, 100 * walk / all,
      static_cast<unsigned long long>(result.cycles.value));
  return {{"unit", name},
          {"rays", result.rays()},
          {"seconds", all},
          {"rays_per_second", rays / all},
          {"walk_seconds", walk},
          {"walk_rays_per_second", rays / walk},
          {"cycles", result.cycles.value},
          {"appointments", result.appointments}};
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
    "bench-simulate", "Rays per second of the timing model, for every unit",
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
