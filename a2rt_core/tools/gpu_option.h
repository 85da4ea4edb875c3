// The option --gpu and the part of --set that goes to it.
#pragma once

#include <string>
#include <vector>

#include "a2rt/config/section.h"
#include "a2rt/timing/machine_config.h"

namespace a2rt::tools {

struct GpuChoice {
  timing::MachineConfig machine;
  config::Section section;  // what the machine read; for the result's `config`
};

// `gpu`: a name (gpus/NAME.toml in the folder of configurations) or a .toml file. Throws UserError
// for unknown names and keys.
GpuChoice choose_gpu(const std::string& gpu, const std::vector<std::string>& set);

// Splits "key=value" settings: those of machine tables (sm., l1., l2., dram., rt., core_mhz, ...)
// go to the machine, the rest to the unit.
struct SplitSettings {
  std::vector<std::string> gpu, unit;
};
SplitSettings split_settings(const std::vector<std::string>& set);

}  // namespace a2rt::tools
