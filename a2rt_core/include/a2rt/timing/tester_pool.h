// A pool of identical pipelined testers, first come first served.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/timing/clock.h"
#include "a2rt/timing/machine_config.h"

namespace a2rt::timing {

// `count` testers of one RT unit. Each starts at most one test per `interval`; a test takes
// `latency`. k tests given to u idle testers end ceil(k/u) - 1 intervals and one latency later.
class TesterPool {
 public:
  TesterPool() = default;
  TesterPool(std::uint32_t count, Cycles latency, Cycles interval, ClockDomain clock)
      : latency_(latency), interval_(interval), clock_(clock), free_(count) {
    A2RT_CHECK(latency.value > 0 && interval.value > 0, "a test takes at least one cycle");
  }

  bool exists() const { return !free_.empty(); }
  std::uint32_t count() const { return static_cast<std::uint32_t>(free_.size()); }

  // Core cycle at which the last of `tests` ends. Calls must come in order of time.
  Cycles issue(Cycles now, std::uint32_t tests) {
    const Cycles own = clock_.from_core(now);
    Cycles start = own;
    for (std::uint32_t i = 0; i < tests; ++i) {
      // Starts are handed out in turn, so the next tester in the ring is the first to be free.
      Cycles& slot = free_[next_];
      start = std::max(own, slot);
      slot = start + interval_;
      next_ = next_ + 1 == free_.size() ? 0 : next_ + 1;
    }
    tests_ += tests;
    queued_cycles_ += start.value - own.value;
    return clock_.to_core(start + latency_);
  }

  std::uint64_t tests() const { return tests_; }
  // Tester-cycles during which no further test could start (RT clock).
  std::uint64_t busy_cycles() const { return tests_ * interval_.value; }
  // Cycles that requests waited for a free tester (RT clock).
  std::uint64_t queued_cycles() const { return queued_cycles_; }
  Cycles latency() const { return latency_; }

 private:
  Cycles latency_{1}, interval_{1};
  ClockDomain clock_;
  std::vector<Cycles> free_;
  std::size_t next_ = 0;
  std::uint64_t tests_ = 0, queued_cycles_ = 0;
};

}  // namespace a2rt::timing
