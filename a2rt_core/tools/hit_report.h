// A unit's hits against the driver's, and the verdicts that make the driver draw the unit's.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "a2rt/workload/workload.h"

namespace a2rt::tools {

class HitReport {
 public:
  void print() const;
  nlohmann::ordered_json match_json() const;
  nlohmann::ordered_json verdicts_json() const;
  std::uint64_t lost() const;

  std::vector<std::pair<std::string, std::uint64_t>> categories;
  std::uint64_t entries = 0, changed = 0, unrealisable = 0;  // of the verdict file; verdicts.h
};

// Writes `verdicts` if it is not empty; `previous` is the file of the pass before, if any.
HitReport report_hits(const Workload& workload, const std::vector<Hit>& hits,
                      const std::string& verdicts, const std::string& previous);

}  // namespace a2rt::tools
