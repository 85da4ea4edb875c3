// A pool of identical pipelined testers, reserved for the cycle in which the operands arrive.
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
//
// A tester is busy for `interval` cycles from its start, so a set of tests fits if and only if no
// cycle has more than `count` of them (interval graphs are perfect). That is all the pool keeps:
// how many are busy in each of the next cycles. Requests may therefore come out of order, as a
// cache hit makes its arrival known before earlier ones are; each takes the first cycles with room.
class TesterPool {
 public:
  TesterPool() = default;
  TesterPool(std::uint32_t count, Cycles latency, Cycles interval, ClockDomain clock)
      : count_(count),
        latency_(latency),
        interval_(interval.value),
        clock_(clock),
        busy_(count == 0 ? 0 : kLeastRing) {
    A2RT_CHECK(latency.value > 0 && interval.value > 0, "a test takes at least one cycle");
    A2RT_CHECK(count < 0x10000, "an RT unit has fewer than 65536 testers of a kind");
  }

  // How far apart, in core cycles, two requests may be out of order.
  static constexpr std::uint64_t kDisorder = 128;

  bool exists() const { return count_ > 0; }
  std::uint32_t count() const { return count_; }

  // Core cycle at which the last of `tests` ends if they can start from core cycle `at` on.
  Cycles issue(Cycles at, std::uint32_t tests) {
    const std::uint64_t own = clock_.from_core(at).value;
    tests_ += tests;
    forget_before(own);
    const std::uint64_t start =
        interval_ == 1 ? reserve_pipelined(own, tests) : reserve(own, tests);
    queued_cycles_ += start - own;
    return clock_.to_core(Cycles{start} + latency_);
  }

  std::uint64_t tests() const { return tests_; }
  // Tester-cycles during which no further test could start (RT clock).
  std::uint64_t busy_cycles() const { return tests_ * interval_; }
  // Cycles that requests waited for a free tester (RT clock).
  std::uint64_t queued_cycles() const { return queued_cycles_; }
  Cycles latency() const { return latency_; }

 private:
  static constexpr std::size_t kLeastRing = 512;
  std::uint16_t& busy_in(std::uint64_t cycle) { return busy_[cycle & (busy_.size() - 1)]; }
  // Nobody asks for the past any more: its places in the ring become free, some at a time.
  void forget_before(std::uint64_t own) {
    constexpr std::uint64_t kAtOnce = 64;
    if (own < first_ + kDisorder + kAtOnce) [[likely]] {
      return;
    }
    const std::uint64_t until = std::min(own - kDisorder, first_ + busy_.size());
    for (; first_ < until; ++first_) {
      busy_in(first_) = 0;
    }
    first_ = own - kDisorder;
  }
  // Makes the ring hold `cycle` and the interval from it on.
  void reach(std::uint64_t cycle) {
    while (cycle + interval_ > first_ + busy_.size()) [[unlikely]] {
      std::vector<std::uint16_t> old(busy_.size() * 2);
      old.swap(busy_);
      for (std::uint64_t c = first_; c < first_ + old.size(); ++c) {
        busy_in(c) = old[c & (old.size() - 1)];
      }
    }
  }
  // Tests that can start in `cycle`.
  std::uint32_t room(std::uint64_t cycle) {
    std::uint32_t most = busy_in(cycle);
    for (std::uint64_t i = 1; i < interval_; ++i) {
      most = std::max<std::uint32_t>(most, busy_in(cycle + i));
    }
    return count_ - most;
  }
  // Gives the tests the first cycles with room; returns the cycle of the last.
  std::uint64_t reserve(std::uint64_t own, std::uint32_t tests) {
    std::uint64_t cycle = first_with_room(own);
    std::uint64_t start = cycle;
    for (std::uint32_t left = tests; left > 0; ++cycle) {
      reach(cycle);
      const std::uint32_t taken = std::min(left, room(cycle));
      if (taken == 0) {
        note_full(cycle);
        continue;
      }
      start = cycle;
      left -= taken;
      for (std::uint64_t c = cycle; c < cycle + interval_; ++c) {
        busy_in(c) = static_cast<std::uint16_t>(busy_in(c) + taken);
      }
    }
    return start;
  }
  // The same for testers that take a test every cycle.
  std::uint64_t reserve_pipelined(std::uint64_t own, std::uint32_t tests) {
    for (std::uint64_t cycle = first_with_room(own);; ++cycle) {
      reach(cycle);
      std::uint16_t& busy = busy_in(cycle);
      const std::uint32_t taken = std::min(tests, count_ - busy);
      if (taken == 0) {
        note_full(cycle);
        continue;
      }
      busy = static_cast<std::uint16_t>(busy + taken);
      tests -= taken;
      if (tests == 0) {
        return cycle;
      }
    }
  }
  std::uint64_t first_with_room(std::uint64_t own) const {
    return own >= full_from_ && own < full_until_ ? full_until_ : own;
  }
  // A run of cycles without room, so that requests behind a long queue need not walk it.
  void note_full(std::uint64_t cycle) {
    if (cycle == full_until_) {
      ++full_until_;
    } else if (cycle < full_from_ || cycle > full_until_) {
      full_from_ = cycle;
      full_until_ = cycle + 1;
    }
  }
  std::uint32_t count_ = 0;
  Cycles latency_{1};
  std::uint64_t interval_ = 1;
  ClockDomain clock_;
  std::vector<std::uint16_t> busy_;  // ring over cycles of the RT clock, from `first_` on
  std::uint64_t first_ = 0;
  std::uint64_t full_from_ = 0, full_until_ = 0;
  std::uint64_t tests_ = 0, queued_cycles_ = 0;
};

}  // namespace a2rt::timing
