// describe-gpu: every parameter of a machine with its value, unit and meaning.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "gpu_option.h"

namespace a2rt::tools {
namespace {

struct Options {
  std::string gpu = "table1";
  std::vector<std::string> set;
};

int describe(const Options& options) {
  const GpuChoice choice = choose_gpu(options.gpu, options.set);
  for (const config::ParameterDoc& p : choice.section.describe()) {
    std::printf("%-28s %12s %-14s %s\n", p.key.c_str(), p.value.c_str(), p.unit.c_str(),
                p.sentence.c_str());
  }
  return 0;
}

const RegisterCommand kCommand(
    "describe-gpu", "Print a machine's parameters and what they mean",
    "  a2rt-core describe-gpu table1\n"
    "  a2rt-core describe-gpu mobile --set l1.capacity=65536\n",
    [](cli::Options& app) {
      auto options = std::make_shared<Options>();
      app.add("gpu", options->gpu, "A name, or a .toml file");
      app.add("--set", options->set, "Parameter, e.g. rt.stack_entries=16").one_value_each();
      return [options] { return describe(*options); };
    });

}  // namespace
}  // namespace a2rt::tools
