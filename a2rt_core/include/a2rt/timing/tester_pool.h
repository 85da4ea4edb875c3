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
  }

  // How far apart, in core cycles, two requests may be out of order.
  static constexpr std::uint64_t kDisorder = 128;

  bool exists() const { return count_ > 0; }
  std::uint32_t count() const { return count_; }

  // Core cycle at which the last of `tests` ends if they can start from core cycle `at` on.
  Cycles issue(Cycles at, std::uint32_t tests) {
    const std::uint64_t own = clock_.from_core(at).value;
    std::uint64_t cycle = own >= full_from_ && own < full_until_ ? full_until_ : own;
    std::uint64_t start = cycle;
    tests_ += tests;
    for (std::uint32_t left = tests; left > 0; ++cycle) {
      if (cycle - own + interval_ + 2 * kDisorder > busy_.size()) [[unlikely]] {
        grow(own);
      }
      const std::uint32_t taken = std::min(left, room(cycle));
      if (taken > 0) {
        start = cycle;
        left -= taken;
        occupy(cycle, taken);
      } else {
        note_full(cycle);
      }
    }
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
  struct Busy {
    std::uint64_t cycle : 48 = 0, testers : 16 = 0;
  };
  Busy& at(std::uint64_t cycle) { return busy_[cycle & (busy_.size() - 1)]; }
  std::uint32_t busy_in(std::uint64_t cycle) {
    const Busy& b = at(cycle);
    return b.cycle == cycle ? static_cast<std::uint32_t>(b.testers) : 0;
  }
  // Tests that can start in `cycle`.
  std::uint32_t room(std::uint64_t cycle) {
    std::uint32_t most = busy_in(cycle);
    for (std::uint64_t i = 1; i < interval_; ++i) {
      most = std::max(most, busy_in(cycle + i));
    }
    return count_ - most;
  }
  void occupy(std::uint64_t cycle, std::uint32_t testers) {
    for (std::uint64_t c = cycle; c < cycle + interval_; ++c) {
      const std::uint32_t now_busy = busy_in(c) + testers;
      A2RT_CHECK(now_busy <= count_, "more tests were started than there are testers");
      Busy& b = at(c);
      b.cycle = c & ((std::uint64_t{1} << 48) - 1);
      b.testers = now_busy & 0xffff;
    }
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
  // Twice the ring; keeps what requests from cycle `own` - kDisorder on can still ask for.
  void grow(std::uint64_t own) {
    std::vector<Busy> old(busy_.size() * 2);
    old.swap(busy_);
    for (const Busy& b : old) {
      if (b.testers > 0 && b.cycle + kDisorder >= own) {
        at(b.cycle) = b;
      }
    }
  }

  std::uint32_t count_ = 0;
  Cycles latency_{1};
  std::uint64_t interval_ = 1;
  ClockDomain clock_;
  std::vector<Busy> busy_;  // ring over cycles of the RT clock
  std::uint64_t full_from_ = 0, full_until_ = 0;
  std::uint64_t tests_ = 0, queued_cycles_ = 0;
};

}  // namespace a2rt::timing
