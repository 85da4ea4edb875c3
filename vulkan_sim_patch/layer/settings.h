// The layer's settings, from the environment. The table for users is in vulkan_sim_patch/README.md.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "layer/log.h"

namespace a2rt::layer {

struct RecordKinds {
  bool rays = true;
  bool results = true;
  bool candidates = true;
};

struct Settings {
  std::string capture_directory;  // A2RT_CAPTURE; empty = no capture
  std::string verdict_file;       // A2RT_VERDICTS; empty = none
  bool rebuild = true;            // A2RT_REBUILD=sah|off
  bool counters = true;           // A2RT_COUNTERS
  RecordKinds records;            // A2RT_RECORDS
  std::uint64_t limit_bytes = 0;  // A2RT_LIMIT; 0 = what the disk and the format allow
  std::uint64_t memory_bytes = std::uint64_t{256} << 20;  // A2RT_MEMORY
  LogLevel log_level = LogLevel::kWarn;                   // A2RT_LOG
  std::optional<std::uint32_t> assumed_driver;            // A2RT_ASSUME_DRIVER_ID, for tests
  std::uint32_t site_limit = UINT32_MAX;                  // A2RT_SITE_LIMIT, to bisect a rewrite
  std::string dump_directory;                             // A2RT_DUMP_SPIRV

  bool capturing() const { return !capture_directory.empty(); }
  bool instrumenting() const { return capturing() || !verdict_file.empty(); }
};

// `environment` are lines NAME=VALUE. Each setting or value that is not understood gives one line
// in `problems` and leaves its default in force.
Settings read_settings(const std::vector<std::string>& environment,
                       std::vector<std::string>& problems);
Settings read_settings_of_process(std::vector<std::string>& problems);

// "64M", "4G", "1048576": bytes; nothing if it is not a size.
std::optional<std::uint64_t> parse_size(const std::string& text);

}  // namespace a2rt::layer
