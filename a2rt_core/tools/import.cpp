// a2rt-core import: a raw capture directory becomes a workload file.
#include "a2rt/workload/import.h"

#include <cstdio>
#include <memory>

#include "a2rt/workload/file.h"
#include "command.h"
#include "progress.h"

namespace a2rt::tools {
namespace {

struct Arguments {
  std::string directory, output;
  ImportOptions import;
  WriteOptions write;
  bool without_nodes = false;
};

void print_summary(const Workload& workload, const ImportReport& report,
                   const std::string& output) {
  std::printf("%s: %zu rays, %zu candidates, %zu segments, %zu dispatches\n", output.c_str(),
              workload.rays.size(), workload.candidates.size(), workload.segments.size(),
              workload.dispatches.size());
  if (report.inferred_hits + report.inferred_misses > 0) {
    std::printf("  without shader record: %llu hits and %llu misses, found by the exact walk\n",
                static_cast<unsigned long long>(report.inferred_hits),
                static_cast<unsigned long long>(report.inferred_misses));
  }
  if (report.overridden > 0) {
    std::printf("  with a verdict applied: %llu\n",
                static_cast<unsigned long long>(report.overridden));
  }
  if (report.unknown > 0) {
    std::printf("  of unknown outcome: %llu\n", static_cast<unsigned long long>(report.unknown));
  }
  if (report.lost + report.orphans > 0) {
    std::printf("  NOT COMPLETE: %llu records lost, %llu out of place\n",
                static_cast<unsigned long long>(report.lost),
                static_cast<unsigned long long>(report.orphans));
  }
}

int run(const Arguments& arguments) {
  ImportReport report;
  Workload workload;
  {
    Progress progress;
    ImportOptions options = arguments.import;
    options.progress = [&](double share, const char* what) { progress.show(0.8 * share, what); };
    workload = import_capture(arguments.directory, options, report);
    progress.show(0.8, "writing");
    WriteOptions write = arguments.write;
    write.driver_nodes = !arguments.without_nodes;
    write_workload(workload, arguments.output, write);
  }
  for (const std::string& warning : report.warnings) {
    std::fprintf(stderr, "a2rt-core: warning: %s\n", warning.c_str());
  }
  print_summary(workload, report, arguments.output);
  return 0;
}

const RegisterCommand kImport(
    "import", "Turn a raw capture of the Vulkan layer into a workload file",
    "  a2rt-core import capture/ -o ship.h5 --scene ship --workload pt\n", [](cli::Options& app) {
      auto arguments = std::make_shared<Arguments>();
      app.add("directory", arguments->directory, "capture directory").required();
      app.add("-o,--output", arguments->output, "workload file to write").required();
      app.add("--scene", arguments->import.scene, "name of the scene, for reports");
      app.add("--workload", arguments->import.workload, "name of the workload, for reports");
      app.flag("--tolerate-lost", arguments->import.tolerate_lost,
               "import although records are missing");
      app.flag("--without-driver-nodes", arguments->without_nodes,
               "leave out the driver's trees (smaller file, no `check`)");
      app.add("--deflate", arguments->write.deflate, "compression level of geometry")
          .check(cli::in_range(0, 9));
      return [arguments] { return run(*arguments); };
    });

}  // namespace
}  // namespace a2rt::tools
