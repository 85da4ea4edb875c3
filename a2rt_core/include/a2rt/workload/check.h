// Proof of a capture: the exact walk repeats every ray and must find what the driver found.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "a2rt/workload/workload.h"

namespace a2rt {

struct CheckDifference {
  std::uint64_t ray = 0;
  Hit driver, walk;
  std::string reason;
};

struct CheckReport {
  std::uint64_t rays = 0;
  std::uint64_t equal = 0;       // hit or miss, t and ids bit-equal
  std::uint64_t different = 0;   // the capture or the walk is wrong
  std::uint64_t overridden = 0;  // a verdict was applied: not the driver's own hit, not walked
  std::uint64_t unknown = 0;     // nothing was recorded that could be compared (unfinished queries)
  std::uint64_t unwalkable = 0;  // the TLAS has no usable driver nodes
  std::uint64_t box_tests = 0, triangle_tests = 0;
  std::uint32_t deepest_stack = 0;
  std::vector<std::string> problems;         // of TLASes that rays refer to
  std::vector<CheckDifference> differences;  // the first ones, in order of rays
  bool passed() const { return different == 0 && unwalkable == 0; }
};

struct CheckOptions {
  std::uint32_t threads = 0;  // 0: as many as the machine has
  std::size_t keep_differences = 20;
  // Called from one thread with the share done, 0 to 1.
  std::function<void(double)> progress;
};

// The result does not depend on the number of threads.
CheckReport check_workload(const Workload& workload, const CheckOptions& options = {});

}  // namespace a2rt
