#include "unit_option.h"

#include <cstdlib>
#include <filesystem>

namespace a2rt::tools {
namespace {

namespace fs = std::filesystem;

config::Section read_section(const std::string& unit, const std::string& config,
                             const std::vector<std::string>& set) {
  if (!config.empty()) {
    return config::Section::from_file(config, set);
  }
  if (unit.ends_with(".toml")) {
    return config::Section::from_file(unit, set);
  }
  const fs::path file = config_folder() / "units" / (unit + ".toml");
  return fs::exists(file) ? config::Section::from_file(file, set)
                          : config::Section::from_text("", "defaults of " + unit, set);
}

}  // namespace

fs::path config_folder() {
  const char* folder = std::getenv("A2RT_CONFIGS");
  return folder != nullptr ? fs::path(folder) : fs::path(A2RT_CONFIG_FOLDER);
}

UnitChoice choose_unit(const std::string& unit, const std::string& config,
                       const std::vector<std::string>& set) {
  config::Section section = read_section(unit, config, set);
  const std::string stem = fs::path(unit).stem().string();
  const std::string name =
      section.text("unit", stem, "Registered unit that these parameters are for");
  UnitChoice choice{unit_registry().create(name, section), section};
  section.reject_unknown_keys();
  return choice;
}

}  // namespace a2rt::tools
