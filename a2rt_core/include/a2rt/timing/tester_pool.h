// A pool of identical pipelined testers, reserved for the cycle in which the operands arrive.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/base/inline.h"
#include "a2rt/timing/clock.h"
#include "a2rt/timing/machine_config.h"

namespace a2rt::timing {

// `count` testers of one RT unit. Each starts at most one test per `interval`; a test takes
// `latency`. k tests given to u idle testers end ceil(k/u) - 1 intervals and one latency later.
//
// A tester is busy for `interval` cycles from its start, so a set of tests fits if and only if no
// cycle has more than `count` of them (interval graphs are perfect). That is all the pool keeps:
// how many are busy in each of the next cycles, and a bit per cycle in which all are. Requests may
// therefore come out of order, as a cache hit makes its arrival known before earlier ones are; each
// takes the first cycles with room.
class TesterPool {
 public:
  TesterPool() = default;
  TesterPool(std::uint32_t count, Cycles latency, Cycles interval, ClockDomain clock)
      : count_(count),
        latency_(latency),
        interval_(interval.value),
        simple_(interval.value == 1 && clock.same()),
        clock_(clock),
        wide_(count > kMostInByte),
        busy_(kLeastRing),
        more_busy_(wide_ ? kLeastRing : 0),
        full_(kLeastRing / 64) {
    A2RT_CHECK(latency.value > 0 && interval.value > 0, "a test takes at least one cycle");
    A2RT_CHECK(count < 0x10000, "an RT unit has fewer than 65536 testers of a kind");
  }

  bool exists() const { return count_ > 0; }
  std::uint32_t count() const { return count_; }

  // Core cycle at which the last of `tests` ends if they can start from core cycle `at` on. Nobody
  // asks for a cycle before `now` any more.
  A2RT_INLINE Cycles issue(Cycles now, Cycles at, std::uint32_t tests) {
    tests_ += tests;
    // Mostly all can start at once, and no tester is busy for more than its first cycle.
    if (simple_ && at.value - first_ <= ring_mask_) [[likely]] {
      const std::uint32_t busy = busy_in(at.value) + tests;
      if (busy <= count_) [[likely]] {
        set_busy(at.value, busy);
        return at + latency_;
      }
    }
    return issue_later(now, at, tests);
  }

  std::uint64_t tests() const { return tests_; }
  // Tester-cycles during which no further test could start (RT clock).
  std::uint64_t busy_cycles() const { return tests_ * interval_; }
  // Cycles that requests waited for a free tester (RT clock).
  std::uint64_t queued_cycles() const { return queued_cycles_; }
  Cycles latency() const { return latency_; }

 private:
  static constexpr std::size_t kLeastRing = 512;
  A2RT_NOINLINE Cycles issue_later(Cycles now, Cycles at, std::uint32_t tests) {
    const std::uint64_t own = clock_.from_core(at).value;
    if (own > first_ + ring_mask_) [[unlikely]] {
      forget_before(clock_.from_core(now).value);
    }
    const std::uint64_t start = interval_ == 1 ? reserve_single(own, tests) : reserve(own, tests);
    queued_cycles_ += start - own;
    return clock_.to_core(Cycles{start} + latency_);
  }
  std::uint32_t busy_in(std::uint64_t cycle) const {
    const std::uint64_t i = cycle & ring_mask_;
    return wide_ ? busy_[i] | std::uint32_t{more_busy_[i]} << 8 : busy_[i];
  }
  std::uint64_t& full_word(std::uint64_t cycle) { return full_[(cycle & ring_mask_) / 64]; }
  // Nobody asks for the past any more: its places in the ring become free, 64 cycles at a time.
  A2RT_NOINLINE void forget_before(std::uint64_t now) {
    const std::uint64_t keep = now / 64 * 64;
    const std::uint64_t until = std::min(keep, first_ + ring_mask_ + 1);
    for (; first_ < until; first_ += 64) {
      std::fill_n(&busy_[first_ & ring_mask_], 64, std::uint8_t{0});
      if (wide_) {
        std::fill_n(&more_busy_[first_ & ring_mask_], 64, std::uint8_t{0});
      }
      full_word(first_) = 0;
    }
    first_ = keep;
  }
  // Makes the ring hold `cycle` and the interval from it on.
  void reach(std::uint64_t cycle) {
    while (cycle + interval_ > first_ + ring_mask_ + 1) [[unlikely]] {
      grow();
    }
  }
  void grow() {
    const std::uint64_t old_mask = ring_mask_;
    ring_mask_ = busy_.size() * 2 - 1;
    const auto move = [&](auto& ring, std::uint64_t cycles_each) {
      std::remove_reference_t<decltype(ring)> old(ring.size() * 2);
      old.swap(ring);
      for (std::uint64_t c = first_; c <= first_ + old_mask && !old.empty(); c += 64) {
        std::copy_n(&old[(c & old_mask) / cycles_each], 64 / cycles_each,
                    &ring[(c & ring_mask_) / cycles_each]);
      }
    };
    move(busy_, 1);
    move(more_busy_, 1);
    move(full_, 64);
  }
  // First cycle at or after `cycle` in which some tester is not busy; the ring holds it.
  std::uint64_t first_not_full(std::uint64_t cycle) {
    while (true) {
      reach(cycle + 63);
      const std::uint64_t open = ~full_word(cycle) >> (cycle % 64);
      if (open != 0) [[likely]] {
        return cycle + static_cast<std::uint64_t>(std::countr_zero(open));
      }
      cycle = (cycle / 64 + 1) * 64;
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
  void set_busy(std::uint64_t cycle, std::uint32_t testers) {
    const std::uint64_t i = cycle & ring_mask_;
    busy_[i] = static_cast<std::uint8_t>(testers);
    if (wide_) [[unlikely]] {
      more_busy_[i] = static_cast<std::uint8_t>(testers >> 8);
    }
    full_word(cycle) |= std::uint64_t{testers == count_} << (cycle % 64);
  }
  // As reserve(), when a tester is busy for the cycle of its start only.
  std::uint64_t reserve_single(std::uint64_t cycle, std::uint32_t tests) {
    while (true) {
      cycle = first_not_full(cycle);
      const std::uint32_t busy = busy_in(cycle) + tests;
      if (busy <= count_) {
        set_busy(cycle, busy);
        return cycle;
      }
      set_busy(cycle, count_);
      tests = busy - count_;
      ++cycle;
    }
  }
  // Gives the tests the first cycles with room; returns the cycle of the last.
  std::uint64_t reserve(std::uint64_t own, std::uint32_t tests) {
    std::uint64_t cycle = own, start = own;
    for (std::uint32_t left = tests; left > 0; ++cycle) {
      cycle = first_not_full(cycle);
      const std::uint32_t taken = std::min(left, room(cycle));
      if (taken == 0) {
        continue;
      }
      start = cycle;
      left -= taken;
      for (std::uint64_t c = cycle; c < cycle + interval_; ++c) {
        set_busy(c, busy_in(c) + taken);
      }
    }
    return start;
  }
  std::uint32_t count_ = 0;
  Cycles latency_{1};
  std::uint64_t interval_ = 1;
  bool simple_ = true;
  ClockDomain clock_;
  static constexpr std::uint32_t kMostInByte = 0xff;
  bool wide_ = false;  // more testers than a byte counts
  // Rings over cycles of the RT clock, from `first_` on. Bytes, as they are what takes most of the
  // host's first cache: a test touches another line of it than the one before.
  std::vector<std::uint8_t> busy_;
  std::vector<std::uint8_t> more_busy_;  // the upper bytes, if `wide_`
  std::vector<std::uint64_t> full_;      // bit per cycle of the ring: no tester is free
  std::uint64_t ring_mask_ = kLeastRing - 1;
  std::uint64_t first_ = 0;  // a multiple of 64
  std::uint64_t tests_ = 0, queued_cycles_ = 0;
};

}  // namespace a2rt::timing
