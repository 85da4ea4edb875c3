#include "a2rt/hard/hard_case.h"

#include "a2rt/base/error.h"
#include "a2rt/workload/workload.h"
#include "cases.h"

namespace a2rt::hard {

const std::vector<HardCase>& hard_cases() {
  static const std::vector<HardCase> all = [] {
    std::vector<HardCase> list;
    for (auto* group : {direction_cases, extent_cases, origin_cases, interval_cases, scene_cases}) {
      for (HardCase& one : group()) {
        list.push_back(std::move(one));
      }
    }
    return list;
  }();
  return all;
}

const HardCase& hard_case(std::string_view key) {
  std::string known;
  for (const HardCase& one : hard_cases()) {
    if (one.key == key) {
      return one;
    }
    known += known.empty() ? one.key : ", " + one.key;
  }
  throw UserError("no hard case is called " + std::string(key) + "; known: " + known);
}

}  // namespace a2rt::hard
