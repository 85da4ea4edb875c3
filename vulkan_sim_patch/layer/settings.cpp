#include "layer/settings.h"

#include <unistd.h>

#include <array>
#include <charconv>
#include <string_view>

namespace a2rt::layer {
namespace {

constexpr std::string_view kPrefix = "A2RT_";

std::optional<std::uint64_t> parse_number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) {
    return std::nullopt;
  }
  return value;
}

bool parse_switch(const std::string& text, bool& target) {
  if (text != "0" && text != "1") {
    return false;
  }
  target = text == "1";
  return true;
}

bool parse_u32(const std::string& text, std::uint32_t& target) {
  const auto value = parse_number(text);
  if (!value || *value > UINT32_MAX) {
    return false;
  }
  target = static_cast<std::uint32_t>(*value);
  return true;
}

bool parse_size_into(const std::string& text, std::uint64_t& target) {
  const auto value = parse_size(text);
  if (!value || *value == 0) {
    return false;
  }
  target = *value;
  return true;
}

bool parse_records(const std::string& text, RecordKinds& target) {
  if (text == "all") {
    target = {};
    return true;
  }
  RecordKinds kinds{false, false, false};
  std::string_view rest = text;
  while (!rest.empty()) {
    const auto comma = rest.find(',');
    const std::string_view word = rest.substr(0, comma);
    if (word == "rays") {
      kinds.rays = true;
    } else if (word == "results") {
      kinds.results = true;
    } else if (word == "candidates") {
      kinds.candidates = true;
    } else {
      return false;
    }
    rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 1);
  }
  // Results and candidates belong to a ray record; without it they are orphans.
  if (!kinds.rays) {
    return false;
  }
  target = kinds;
  return true;
}

struct Setting {
  std::string_view name;
  std::string_view values;  // for the message
  bool (*parse)(const std::string& text, Settings& settings);
};

constexpr std::array kSettings = {
    Setting{"A2RT_CAPTURE", "a directory",
            [](const std::string& t, Settings& s) {
              s.capture_directory = t;
              return true;
            }},
    Setting{"A2RT_VERDICTS", "a verdict file",
            [](const std::string& t, Settings& s) {
              s.verdict_file = t;
              return true;
            }},
    Setting{"A2RT_REBUILD", "sah or off",
            [](const std::string& t, Settings& s) {
              s.rebuild = t == "sah";
              return t == "sah" || t == "off";
            }},
    Setting{"A2RT_COUNTERS", "0 or 1",
            [](const std::string& t, Settings& s) { return parse_switch(t, s.counters); }},
    Setting{"A2RT_RECORDS", "all, or a list of rays, results, candidates that has rays",
            [](const std::string& t, Settings& s) { return parse_records(t, s.records); }},
    Setting{"A2RT_LIMIT", "a size such as 512M or 8G",
            [](const std::string& t, Settings& s) { return parse_size_into(t, s.limit_bytes); }},
    Setting{"A2RT_MEMORY", "a size such as 256M",
            [](const std::string& t, Settings& s) { return parse_size_into(t, s.memory_bytes); }},
    Setting{"A2RT_LOG", "quiet, warn, info or debug",
            [](const std::string& t, Settings& s) {
              constexpr std::array<std::string_view, 4> kNames = {"quiet", "warn", "info", "debug"};
              for (std::size_t i = 0; i < kNames.size(); ++i) {
                if (t == kNames[i]) {
                  s.log_level = static_cast<LogLevel>(i);
                  return true;
                }
              }
              return false;
            }},
    Setting{"A2RT_ASSUME_DRIVER_ID", "a VkDriverId number",
            [](const std::string& t, Settings& s) {
              std::uint32_t id = 0;
              const bool good = parse_u32(t, id);
              if (good) {
                s.assumed_driver = id;
              }
              return good;
            }},
    Setting{"A2RT_SITE_LIMIT", "a number of trace instructions",
            [](const std::string& t, Settings& s) { return parse_u32(t, s.site_limit); }},
    Setting{"A2RT_DUMP_SPIRV", "a directory",
            [](const std::string& t, Settings& s) {
              s.dump_directory = t;
              return true;
            }},
};

// Variables of the project's other programs that share the prefix.
// tests/repo checks that none is forgotten.
constexpr std::array<std::string_view, 6> kForeign = {"A2RT_BUILD_DIR", "A2RT_CONFIGS",
                                                      "A2RT_NO_SETUP",  "A2RT_PROGRESS",
                                                      "A2RT_PYTHON",    "A2RT_SCENES"};

std::string known_names() {
  std::string names;
  for (const Setting& setting : kSettings) {
    names += (names.empty() ? "" : ", ") + std::string(setting.name);
  }
  return names;
}

void apply(const std::string& name, const std::string& value, Settings& settings,
           std::vector<std::string>& problems) {
  for (const Setting& setting : kSettings) {
    if (setting.name != name) {
      continue;
    }
    Settings changed = settings;
    if (value.empty() || !setting.parse(value, changed)) {
      problems.push_back("setting " + name + "=\"" + value + "\" is not understood; it takes " +
                         std::string(setting.values) + "; the default is used");
    } else {
      settings = changed;
    }
    return;
  }
  for (const std::string_view foreign : kForeign) {
    if (foreign == name) {
      return;
    }
  }
  problems.push_back("setting " + name + " is unknown and has no effect; known are " +
                     known_names());
}

}  // namespace

std::optional<std::uint64_t> parse_size(const std::string& text) {
  if (text.empty()) {
    return std::nullopt;
  }
  std::string_view digits = text;
  unsigned shift = 0;
  switch (text.back()) {
    case 'K':
      shift = 10;
      break;
    case 'M':
      shift = 20;
      break;
    case 'G':
      shift = 30;
      break;
    default:
      break;
  }
  if (shift != 0) {
    digits.remove_suffix(1);
  }
  const auto value = parse_number(digits);
  if (!value || *value > (UINT64_MAX >> shift)) {
    return std::nullopt;
  }
  return *value << shift;
}

Settings read_settings(const std::vector<std::string>& environment,
                       std::vector<std::string>& problems) {
  Settings settings;
  for (const std::string& line : environment) {
    const auto equals = line.find('=');
    if (equals == std::string::npos || line.compare(0, kPrefix.size(), kPrefix) != 0) {
      continue;
    }
    apply(line.substr(0, equals), line.substr(equals + 1), settings, problems);
  }
  return settings;
}

Settings read_settings_of_process(std::vector<std::string>& problems) {
  std::vector<std::string> lines;
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
    lines.emplace_back(*entry);
  }
  return read_settings(lines, problems);
}

}  // namespace a2rt::layer
