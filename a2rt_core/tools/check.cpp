// a2rt-core check: the exact walk must find what the driver found, for every ray.
#include "a2rt/workload/check.h"

#include <cstdio>
#include <memory>

#include "a2rt/workload/file.h"
#include "command.h"
#include "progress.h"

namespace a2rt::tools {
namespace {

struct Arguments {
  std::string file;
  CheckOptions check;
};

void print_hit(const char* who, const Hit& hit) {
  if (hit.state == HitState::kMiss) {
    std::printf("    %s: miss\n", who);
  } else {
    std::printf("    %s: t %.9g instance %u geometry %u primitive %u kind 0x%x\n", who,
                static_cast<double>(hit.t), hit.instance, hit.geometry, hit.primitive, hit.kind);
  }
}

void print_difference(const Workload& workload, const CheckDifference& d) {
  const Ray& ray = workload.rays[d.ray];
  std::printf(
      "  ray %llu (dispatch %u launch %u ordinal %u flags 0x%x mask 0x%x): %s\n"
      "    origin %.9g %.9g %.9g dir %.9g %.9g %.9g t %.9g to %.9g\n",
      static_cast<unsigned long long>(d.ray), ray.dispatch, ray.launch, ray.ordinal, ray.flags,
      ray.mask, d.reason.c_str(), static_cast<double>(ray.origin.x),
      static_cast<double>(ray.origin.y), static_cast<double>(ray.origin.z),
      static_cast<double>(ray.dir.x), static_cast<double>(ray.dir.y),
      static_cast<double>(ray.dir.z), static_cast<double>(ray.tmin), static_cast<double>(ray.tmax));
  print_hit("driver", d.driver);
  print_hit("walk  ", d.walk);
}

void print_report(const Workload& workload, const CheckReport& report) {
  const auto number = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  const auto compared =
      static_cast<double>(std::max<std::uint64_t>(report.equal + report.different, 1));
  std::printf("%llu rays: %llu bit-equal, %llu different (%.5f %% equal)\n", number(report.rays),
              number(report.equal), number(report.different),
              100.0 * static_cast<double>(report.equal) / compared);
  if (report.overridden + report.unknown + report.unwalkable > 0) {
    std::printf(
        "  not compared: %llu with a verdict applied, %llu unknown, %llu without usable "
        "driver nodes\n",
        number(report.overridden), number(report.unknown), number(report.unwalkable));
  }
  std::printf("  per ray: %.1f box nodes, %.1f triangles; deepest stack %u\n",
              static_cast<double>(report.box_tests) / compared,
              static_cast<double>(report.triangle_tests) / compared, report.deepest_stack);
  for (const std::string& problem : report.problems) {
    std::printf("  %s\n", problem.c_str());
  }
  for (const CheckDifference& d : report.differences) {
    print_difference(workload, d);
  }
}

int run(const Arguments& arguments) {
  const Workload workload = read_workload(arguments.file);
  CheckReport report;
  {
    Progress progress;
    CheckOptions options = arguments.check;
    options.progress = [&](double share) { progress.show(share, "walking the driver's nodes"); };
    report = check_workload(workload, options);
  }
  print_report(workload, report);
  return report.passed() ? 0 : 1;
}

const RegisterCommand kCheck(
    "check", "Repeat every ray on the driver's own nodes; exit 1 unless all are bit-equal",
    "  a2rt-core check ship.h5\n", [](cli::Options& app) {
      auto arguments = std::make_shared<Arguments>();
      app.add("file", arguments->file, "workload file").required();
      app.add("--threads", arguments->check.threads, "0: one per processor");
      app.add("--show", arguments->check.keep_differences, "differences to print");
      return [arguments] { return run(*arguments); };
    });

}  // namespace
}  // namespace a2rt::tools
