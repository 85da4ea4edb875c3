// tester: what a quantized box tester of A2RT's precision costs, beside the published one.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "a2rt/arith/precision.h"
#include "a2rt/base/error.h"
#include "a2rt/energy/qbox_area.h"
#include "a2rt/energy/table.h"
#include "a2rt/rt/a2rt_precision.h"
#include "command.h"
#include "unit_option.h"

namespace a2rt::tools {
namespace {

struct Options {
  std::string unit = "a2rt";
  std::vector<std::string> set;
};

int run(const Options& options) {
  const UnitChoice choice = choose_unit(options.unit, "", options.set);
  const std::string& name = choice.unit->info().name;
  if (!name.starts_with("a2rt")) {
    throw UserError("--unit " + options.unit +
                    ": its testers are not A2RT's, which this scales; use " +
                    "a2rt, a2rt-literal or a .toml file of one");
  }
  const arith::A2rtPrecision precision =
      rt::read_a2rt_precision(choice.section, rt::default_origin(name));
  const auto table = energy::EnergyTable::from_file(A2RT_ENERGY_FOLDER "/12nm.csv");
  const energy::Row row = energy::for_precision(table, precision).find("qbox_a2rt", "test");
  const nlohmann::ordered_json json = {{"unit", options.unit},
                                       {"box_bits", precision.box_bits},
                                       {"origin", arith::name_of(precision.origin)},
                                       {"origin_bits", precision.effective_origin_bits()},
                                       {"scale", energy::qbox_scale(precision)},
                                       {"area_um2", row.area_um2},
                                       {"energy_pj", row.energy_pj},
                                       {"leak_uw", row.leak_uw},
                                       {"note", energy::note_name(row.note)},
                                       {"source", row.source}};
  std::printf("%s\n", json.dump(2).c_str());
  return 0;
}

const RegisterCommand kCommand(
    "tester", "Area and energy of a unit's quantized box tester, scaled from the published one",
    "  a2rt-core tester --unit a2rt\n"
    "  a2rt-core tester --unit a2rt --set precision.box_bits=6\n",
    [](cli::Options& app) {
      auto options = std::make_shared<Options>();
      app.add("--unit", options->unit, "a2rt, a2rt-literal, or a .toml file of such a unit");
      app.add("--set", options->set, "Parameter, e.g. precision.box_bits=6").one_value_each();
      return [options] { return run(*options); };
    });

}  // namespace
}  // namespace a2rt::tools
