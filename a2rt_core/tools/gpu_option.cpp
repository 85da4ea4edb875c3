#include "gpu_option.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "a2rt/base/error.h"
#include "unit_option.h"

namespace a2rt::tools {
namespace {

namespace fs = std::filesystem;

std::string known_gpus(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == ".toml") {
      names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  std::string all;
  for (const std::string& name : names) {
    all += (all.empty() ? "" : ", ") + name;
  }
  return all;
}

}  // namespace

GpuChoice choose_gpu(const std::string& gpu, const std::vector<std::string>& set) {
  fs::path file = gpu;
  if (!gpu.ends_with(".toml")) {
    const fs::path folder = config_folder() / "gpus";
    file = folder / (gpu + ".toml");
    if (!fs::exists(file)) {
      throw UserError("no GPU named '" + gpu + "'; known: " + known_gpus(folder) +
                      "; or give a .toml file");
    }
  }
  config::Section section = config::Section::from_file(file, set);
  GpuChoice choice{timing::MachineConfig::from_section(section), section};
  section.reject_unknown_keys();
  return choice;
}

SplitSettings split_settings(const std::vector<std::string>& set) {
  static constexpr std::array<std::string_view, 9> kMachine = {"sm.",
                                                               "l1.",
                                                               "l2.",
                                                               "dram.",
                                                               "rt.",
                                                               "core_mhz=",
                                                               "model=",
                                                               "shader_memory=",
                                                               "watchdog_cycles="};
  SplitSettings split;
  for (const std::string& s : set) {
    const bool machine = std::any_of(kMachine.begin(), kMachine.end(),
                                     [&](std::string_view key) { return s.starts_with(key); });
    (machine ? split.gpu : split.unit).push_back(s);
  }
  return split;
}

}  // namespace a2rt::tools
