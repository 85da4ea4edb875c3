// units: the RT units that can be simulated, and every parameter of one.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "unit_option.h"

namespace a2rt::tools {
namespace {

struct Options {
  std::string unit;
  std::vector<std::string> set;
};

const char* promise_text(Promise promise) {
  switch (promise) {
    case Promise::kExact:
      return "exact boxes";
    case Promise::kConservative:
      return "never misses";
    case Promise::kMayMiss:
      return "can miss";
  }
  return "";
}

int list_units() {
  for (const std::string& name : unit_registry().names()) {
    const UnitChoice choice = choose_unit(name, "", {});
    const UnitInfo& info = choice.unit->info();
    std::printf("%-14s %-14s %s\n%-29s %s\n", name.c_str(), promise_text(info.promise),
                info.title.c_str(), "", info.source.c_str());
  }
  return 0;
}

int describe_unit(const Options& options) {
  const UnitChoice choice = choose_unit(options.unit, "", options.set);
  for (const config::ParameterDoc& p : choice.section.describe()) {
    std::printf("%-28s %12s %-10s %s\n", p.key.c_str(), p.value.c_str(), p.unit.c_str(),
                p.sentence.c_str());
  }
  return 0;
}

const RegisterCommand kCommand(
    "units", "List the RT units, or every parameter of one",
    "  a2rt-core units\n"
    "  a2rt-core units a2rt\n"
    "  a2rt-core units a2rt --set precision.box_bits=6\n",
    [](cli::Options& app) {
      auto options = std::make_shared<Options>();
      app.add("unit", options->unit, "A name, or a .toml file; none lists all");
      app.add("--set", options->set, "Parameter, e.g. precision.box_bits=6").one_value_each();
      return [options] { return options->unit.empty() ? list_units() : describe_unit(*options); };
    });

}  // namespace
}  // namespace a2rt::tools
