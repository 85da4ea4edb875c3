// Hard cases for whole RT units: geometry and rays that the papers do not mention, as workloads.
//
// Each case is one row of section 4's table of the numerical requirements ("what must happen when
// ..."), made in memory: no Vulkan, no file, the same bits on every machine.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace a2rt {
struct Workload;
}

namespace a2rt::hard {

struct HardCase {
  std::string key;    // "axis_parallel"; names the test and the JSON row
  std::string group;  // "Directions", "Extents", "Origins", "Intervals", "Scenes"
  std::string title;  // one line for tables
  std::string what;   // one sentence: which geometry, which rays
  Workload (*make)();
};

// All cases, in the order of the table.
const std::vector<HardCase>& hard_cases();
// Throws UserError naming the known keys.
const HardCase& hard_case(std::string_view key);

}  // namespace a2rt::hard
