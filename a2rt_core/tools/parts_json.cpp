#include "parts_json.h"

#include <nlohmann/json.hpp>

namespace a2rt::tools {

nlohmann::ordered_json parts_json(const Parts& called_for, const Parts& instantiated) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < kPartCount; ++i) {
    const auto part = static_cast<Part>(i);
    const std::string cause = part_cause(part);
    all.push_back({{"part", part_name(part)},
                   {"called_for", called_for.has(part)},
                   {"instantiated", instantiated.has(part)},
                   {"why", (called_for.has(part) ? "called for by: " : "no ") + cause}});
  }
  return all;
}

}  // namespace a2rt::tools
