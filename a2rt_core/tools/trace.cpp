// trace: what a unit finds for every ray of a workload, without time.
#include <sys/resource.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "a2rt/base/text_file.h"
#include "a2rt/rt/functional.h"
#include "a2rt/rt/names.h"
#include "a2rt/rt/result_json.h"
#include "a2rt/workload/file.h"
#include "command.h"
#include "hit_report.h"
#include "progress.h"
#include "unit_option.h"

namespace a2rt::tools {
namespace {

struct Options {
  std::string workload, unit = "baseline", config, output, hits, verdicts, previous;
  std::vector<std::string> set;
  std::uint64_t audit = 0;
  unsigned threads = 0;
};

std::uint64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

void print_summary(const rt::FunctionalResult& result, const UnitInfo& info) {
  std::printf("%s: %zu rays in %.2f s\n", info.title.c_str(), result.hits.size(), result.seconds);
  for (std::size_t k = 1; k < result.totals.traffic.size(); ++k) {
    const rt::TrafficTotal& t = result.totals.traffic[k];
    if (t.accesses > 0) {
      std::printf("  %-12s %12llu accesses %14llu bytes\n", name_of(static_cast<Traffic>(k)),
                  static_cast<unsigned long long>(t.accesses),
                  static_cast<unsigned long long>(t.bytes));
    }
  }
  if (result.audited_rays > 0) {
    const Audit& a = result.audit;
    std::printf(
        "  audit of %llu rays: %llu quantized tests, %llu exact hits, %llu redundant, %llu "
        "missed, %llu escapes\n",
        static_cast<unsigned long long>(result.audited_rays),
        static_cast<unsigned long long>(a.qbox_tests),
        static_cast<unsigned long long>(a.exact_hits),
        static_cast<unsigned long long>(a.redundant_hits),
        static_cast<unsigned long long>(a.missed_hits), static_cast<unsigned long long>(a.escapes));
    for (const auto& [mechanism, count] : a.missed_by_mechanism) {
      std::printf("    missed by %s: %llu\n", mechanism.c_str(),
                  static_cast<unsigned long long>(count));
    }
  }
}

int trace(const Options& options) {
  ReadOptions read;
  read.driver_nodes = !options.verdicts.empty();  // verdicts are proved by the exact walk
  const UnitChoice choice = choose_unit(options.unit, options.config, options.set);
  const Workload workload = read_workload(options.workload, read);
  RtUnit& unit = *choice.unit;
  rt::FunctionalResult result;
  {
    Progress progress;
    progress.show(0, "building " + unit.info().name);
    unit.build(workload);
    rt::FunctionalOptions run;
    run.threads = options.threads == 0 ? std::thread::hardware_concurrency() : options.threads;
    run.audit_rays = options.audit;
    run.progress = [&](double share) { progress.show(share, "tracing " + unit.info().name); };
    result = rt::run_functional(unit, workload, run);
  }
  print_summary(result, unit.info());
  const HitReport report = report_hits(workload, result.hits, options.verdicts, options.previous);
  report.print();
  if (!options.hits.empty()) {
    write_text_file(options.hits,
                    std::string_view(reinterpret_cast<const char*>(result.hits.data()),
                                     result.hits.size() * sizeof(Hit)));
  }
  if (!options.output.empty()) {
    nlohmann::ordered_json json;
    json["schema"] = 1;
    json["workload"] = rt::workload_json(workload, options.workload);
    json["unit"] = rt::unit_json(unit.info());
    json["gpu"] = nullptr;
    json["config"] = rt::config_json(choice.section);
    json["structure"] = rt::structure_json(unit.structure());
    json["driver_match"] = report.match_json();
    json["accuracy"] = rt::accuracy_json(result, report.lost());
    json["events"] = rt::events_json(result.totals);
    json["memory"] = {{"by_kind", rt::traffic_json(result.totals)}};
    if (!options.verdicts.empty()) {
      json["verdicts"] = report.verdicts_json();
    }
    json["provenance"] = {
        {"tool", "a2rt-core trace"}, {"seconds", result.seconds}, {"peak_bytes", peak_bytes()}};
    write_text_file(options.output, json.dump(2) + "\n");
  }
  return 0;
}

const RegisterCommand kCommand(
    "trace", "Trace a workload through a unit: hits, traffic and accuracy, without time",
    "  a2rt-core trace w.h5 --unit a2rt -o r.json\n"
    "  a2rt-core trace w.h5 --unit aqb8 --set artifact=true --audit 10000\n"
    "  a2rt-core trace w.h5 --unit a2rt --set precision.box_bits=6 --verdicts v.bin\n",
    [](cli::Options& app) {
      auto options = std::make_shared<Options>();
      app.add("workload", options->workload, "Workload file").required();
      app.add("--unit", options->unit, "Unit: a name, or a .toml file of parameters");
      app.add("--config", options->config, "Take the unit's parameters from this file");
      app.add("--set", options->set, "Parameter, e.g. classify.area_ratio=0.01").one_value_each();
      app.add("--audit", options->audit,
              "Compare the box decisions of this many rays with exact arithmetic");
      app.add("--threads", options->threads, "Threads; 0: all (never changes a result)");
      app.add("-o,--output", options->output, "Result as JSON");
      app.add("--hits", options->hits, "Hits as raw 24-byte records, one per ray");
      app.add("--verdicts", options->verdicts, "Verdict file for the Vulkan layer");
      app.add("--previous", options->previous,
              "Verdict file of the pass before; counts what changed");
      return [options] { return trace(*options); };
    });

}  // namespace
}  // namespace a2rt::tools
