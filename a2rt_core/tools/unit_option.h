// The options --unit, --config and --set, which several commands share.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "a2rt/config/section.h"
#include "a2rt/rt/unit.h"

namespace a2rt::tools {

// Folder of configurations: $A2RT_CONFIGS, else the source tree's.
std::filesystem::path config_folder();

struct UnitChoice {
  std::unique_ptr<RtUnit> unit;
  config::Section section;  // what the unit read; for the result's `config`
};

// `unit`: a name or a .toml file. A name takes its parameters from units/NAME.toml in the folder of
// configurations ($A2RT_CONFIGS, else the source tree's), or has the defaults if there is no such
// file. A file names its unit with the key `unit`, or by its own name. `config` overrides where the
// parameters come from; `set` holds "key=value". Throws UserError for unknown units and keys,
// naming file:line:column if they stand in a file.
UnitChoice choose_unit(const std::string& unit, const std::string& config,
                       const std::vector<std::string>& set);

}  // namespace a2rt::tools
