// bench-units: functional speed of every unit and of Embree on the same rays, one thread.
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "a2rt/base/text_file.h"
#include "a2rt/base/thread_clock.h"
#include "a2rt/rt/unit.h"
#include "a2rt/workload/file.h"
#include "a2rt/workload/reference.h"
#include "a2rt/workload/synthetic.h"
#include "bench_embree.h"
#include "bench_memory.h"
#include "command.h"
#include "unit_option.h"

namespace a2rt::tools {
namespace {

struct Options {
  std::string workload, output;
  std::vector<std::string> units;
  std::size_t rays = 200000;
  unsigned repeats = 3;
};

std::uint64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

// Every stride-th ray, so that all kinds of rays of the workload are in the sample.
std::vector<std::size_t> sample(const Workload& workload, std::size_t wanted) {
  std::vector<std::size_t> rays;
  const std::size_t stride = std::max<std::size_t>(1, workload.rays.size() / wanted);
  for (std::size_t i = 0; i < workload.rays.size(); i += stride) {
    rays.push_back(i);
  }
  return rays;
}

template <class Trace>
double seconds_of_pass(const std::vector<std::size_t>& rays, const Trace& trace) {
  const double start = thread_seconds();
  for (const std::size_t i : rays) {
    trace(i);
  }
  return thread_seconds() - start;
}

// What all units of a run are measured on.
struct Bench {
  const Workload& workload;
  const EmbreeScene& embree;
  const std::vector<std::size_t>& rays;
  unsigned repeats;
  double primitives;
};

struct Speed {
  double embree = 1e300, unit = 1e300, events = 1e300;  // seconds of the best pass
  std::uint64_t hits = 0;
};

// Embree, the unit, and the unit with its events take turns, so that other work on the machine
// hits all of them; of each the best pass counts, because such work only ever slows one down.
Speed measure(const Bench& bench, const RtUnit& unit) {
  Speed speed;
  std::vector<Event> events;
  const auto input = [&](std::size_t i) {
    return RayInput{&bench.workload.rays[i], candidates_of(bench.workload, i)};
  };
  for (unsigned r = 0; r < bench.repeats; ++r) {
    speed.embree = std::min(speed.embree, seconds_of_pass(bench.rays, [&](std::size_t i) {
                              bench.embree.trace(bench.workload.rays[i]);
                            }));
    speed.hits = 0;
    speed.unit = std::min(speed.unit, seconds_of_pass(bench.rays, [&](std::size_t i) {
                            speed.hits += unit.trace(input(i)).state == HitState::kHit;
                          }));
    speed.events = std::min(speed.events, seconds_of_pass(bench.rays, [&](std::size_t i) {
                              events.clear();
                              unit.trace(input(i), events);
                            }));
  }
  return speed;
}

nlohmann::json bench_unit(const std::string& name, const Bench& bench) {
  const auto unit = choose_unit(name, "", {}).unit;
  const PeakMemory memory;
  const double start = thread_seconds();
  unit->build(bench.workload);
  const double build = thread_seconds() - start;
  const std::uint64_t build_bytes = memory.growth();
  const Speed speed = measure(bench, *unit);
  const auto rays = static_cast<double>(bench.rays.size());
  const StructureStats s = unit->structure();
  std::printf(
      "%-13s %8.3f Mray/s  %5.2fx Embree  with events %6.3f Mray/s  build %6.3f s = SAH %6.3f + "
      "classify %6.3f + encode %6.3f (%4.1f %% on top), %4.0f B/primitive at its peak  nodes %5.1f "
      "B/primitive\n",
      name.c_str(), rays / speed.unit / 1e6, speed.embree / speed.unit, rays / speed.events / 1e6,
      build, s.build_seconds, s.classify_seconds, s.encode_seconds,
      100 * (s.classify_seconds + s.encode_seconds) / s.build_seconds,
      static_cast<double>(build_bytes) / bench.primitives,
      static_cast<double>(s.node_bytes) / bench.primitives);
  return {{"unit", name},
          {"rays_per_second", rays / speed.unit},
          {"rays_per_second_with_events", rays / speed.events},
          {"embree_rays_per_second", rays / speed.embree},
          {"ratio_to_embree", speed.embree / speed.unit},
          {"hits", speed.hits},
          {"build_seconds", s.build_seconds},
          {"classify_seconds", s.classify_seconds},
          {"encode_seconds", s.encode_seconds},
          {"total_seconds", build},
          {"build_peak_bytes", build_bytes},
          {"build_peak_bytes_per_primitive", static_cast<double>(build_bytes) / bench.primitives},
          {"node_bytes", s.node_bytes}};
}

std::string default_synthetic_name() { return "synthetic torus, 100,000 triangles"; }

Workload load(const Options& options) {
  if (!options.workload.empty()) {
    ReadOptions read;
    read.driver_nodes = false;
    return read_workload(options.workload, read);
  }
  synthetic::Config config;
  config.shape = synthetic::Shape::kTorus;
  config.primitives = 100000;
  config.width = config.height = 192;
  config.reference = false;
  return synthetic::make(config);
}

int bench(const Options& options) {
  const Workload workload = load(options);
  std::uint64_t primitives = 0;
  for (const Blas& blas : workload.blas) {
    primitives += blas.primitive_count();
  }
  const auto triangles = static_cast<double>(primitives);
  const std::vector<std::size_t> rays = sample(workload, options.rays);
  std::printf(
      "%s: %llu primitives, %zu of %zu rays, one thread, best of %u\n",
      options.workload.empty() ? default_synthetic_name().c_str() : options.workload.c_str(),
      static_cast<unsigned long long>(primitives), rays.size(), workload.rays.size(),
      options.repeats);
  nlohmann::json results = nlohmann::json::array();
  double embree_rate = 0;
  {
    const EmbreeScene embree(workload);
    const Bench bench{workload, embree, rays, options.repeats, triangles};
    for (const std::string& name :
         options.units.empty() ? unit_registry().names() : options.units) {
      results.push_back(bench_unit(name, bench));
      embree_rate = std::max(embree_rate, results.back()["embree_rays_per_second"].get<double>());
    }
  }
  std::printf("%-13s %8.3f Mray/s  (rtcIntersect1, robust)\n", "embree", embree_rate / 1e6);
  std::printf("peak memory %.0f MB, %.0f bytes a primitive (rays included)\n",
              static_cast<double>(peak_bytes()) / 1e6,
              static_cast<double>(peak_bytes()) / triangles);
  if (!options.output.empty()) {
    write_text_file(options.output, nlohmann::json{{"workload", options.workload},
                                                   {"primitives", primitives},
                                                   {"rays", rays.size()},
                                                   {"embree_rays_per_second", embree_rate},
                                                   {"peak_bytes", peak_bytes()},
                                                   {"units", results}}
                                            .dump(2) +
                                        "\n");
  }
  return 0;
}

const RegisterCommand kCommand(
    "bench-units", "Rays per second of every unit and of Embree on the same rays",
    "  a2rt-core bench-units\n  a2rt-core bench-units w.h5 --units baseline,a2rt\n",
    [](cli::Options& app) {
      auto options = std::make_shared<Options>();
      app.add("workload", options->workload, "Workload file; none: a synthetic torus");
      app.add("--units", options->units, "Units: names, or .toml files; all if not given")
          .delimiter(',');
      app.add("--rays", options->rays, "Rays to sample").check(cli::positive());
      app.add("--repeats", options->repeats, "Passes; the best counts")
          .check(cli::in_range(1, 100));
      app.add("-o,--output", options->output, "JSON file to write");
      return [options] { return bench(*options); };
    });

}  // namespace
}  // namespace a2rt::tools
