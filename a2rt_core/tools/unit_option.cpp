#include "unit_option.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "a2rt/base/error.h"

namespace a2rt::tools {
namespace {

namespace fs = std::filesystem;

// The file that holds the unit's parameters; empty: it has its defaults.
fs::path parameter_file(const std::string& unit, const std::string& config) {
  if (!config.empty()) {
    return config;
  }
  if (unit.ends_with(".toml")) {
    return unit;
  }
  const fs::path file = config_folder() / "units" / (unit + ".toml");
  return fs::exists(file) ? file : fs::path();
}

std::string join(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) {
    all += (all.empty() ? "" : ", ") + word;
  }
  return all;
}

}  // namespace

fs::path config_folder() {
  const char* folder = std::getenv("A2RT_CONFIGS");
  return folder != nullptr ? fs::path(folder) : fs::path(A2RT_CONFIG_FOLDER);
}

UnitChoice choose_unit(const std::string& unit, const std::string& config,
                       const std::vector<std::string>& set) {
  const fs::path file = parameter_file(unit, config);
  config::Section section = file.empty()
                                ? config::Section::from_text("", "defaults of " + unit, set)
                                : config::Section::from_file(file, set);
  const std::vector<std::string> known = unit_registry().names();
  const std::string stem = fs::path(unit).stem().string();
  const std::string name =
      section.choice("unit", stem, known, "Registered unit that these parameters are for");
  // A name that stands in no file was not checked above.
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    throw UserError(
        file.empty()
            ? "no RT unit named '" + name + "'; known: " + join(known) + "; or give a .toml file"
            : section.where("unit") + ": no RT unit is called '" + name +
                  "'; say which one these parameters are for: unit = one of " + join(known));
  }
  UnitChoice choice{unit_registry().create(name, section), section};
  section.reject_unknown_keys();
  return choice;
}

}  // namespace a2rt::tools
