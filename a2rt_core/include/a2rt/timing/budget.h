// A port's bandwidth as a type: uses go out in order, at most `limit` in a cycle of its clock. A
// model that would send more than its hardware could stops with an error instead of printing a
// nicer figure.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/base/units.h"
#include "a2rt/timing/clock.h"
#include "a2rt/timing/wrap.h"

namespace a2rt::timing {

class Port {
 public:
  // `limit` uses per cycle of `clock`.
  explicit Port(std::uint32_t limit, ClockDomain clock = {}) : limit_(limit), clock_(clock) {
    A2RT_CHECK(limit > 0, "a port of 0 uses per cycle would never let anything pass");
  }

  // Core cycle of the next use, if it is wanted at `now` or later.
  Cycles next(Cycles now) const {
    const Cycles free = used_ < limit_ ? cycle_ : following_;
    return now <= free ? free : clock_.same() ? now : clock_.to_core(clock_.from_core(now));
  }
  // Uses the port in core cycle `at`, an edge of its clock. Throws InternalError if more than the
  // limit goes through in one cycle, or if time runs backwards.
  void use(Cycles at) {
    if (at != cycle_ || cycles_used_ == 0) {
      A2RT_CHECK(at >= following_, "a port was used in the past or between cycles of its clock");
      cycle_ = at;
      following_ = clock_.same()
                       ? at + Cycles{1}
                       : std::max(at + Cycles{1}, clock_.to_core(clock_.from_core(at) + Cycles{1}));
      used_ = 0;
      ++cycles_used_;
    }
    A2RT_CHECK(used_ < limit_, "a port's bandwidth was overspent");
    ++used_;
  }
  // A port that lets one use through in every core cycle.
  bool simple() const { return limit_ == 1 && clock_.same(); }
  // Uses a simple port in cycles of which `last` is the last; they were asked of next().
  void use_until(Cycles last, std::uint64_t uses) {
    A2RT_CHECK(last >= following_ || cycles_used_ == 0, "a port was used in the past");
    cycle_ = last;
    following_ = last + Cycles{1};
    used_ = 1;
    cycles_used_ += uses;
  }
  // Cycles of its clock in which anything went through.
  std::uint64_t cycles_used() const { return cycles_used_; }
  // First core cycle after the last use.
  Cycles end() const { return cycles_used_ == 0 ? cycle_ : cycle_ + Cycles{1}; }

 private:
  std::uint32_t limit_;
  std::uint32_t used_ = 0;
  ClockDomain clock_;
  Cycles cycle_, following_;
  std::uint64_t cycles_used_ = 0;
};

// The banks of a cache: one access per cycle each, reserved up to 63 cycles ahead.
class Banks {
 public:
  explicit Banks(std::uint32_t count) : taken_(count), wrap_(count) {
    A2RT_CHECK(count > 0, "a cache has at least one bank");
  }
  // Time has come to `now`; it only moves forward.
  void advance(Cycles now) {
    if (now == base_) {
      return;
    }
    const std::uint64_t by = now.value - base_.value;
    base_ = now;
    if (by < 64) {
      for (std::uint64_t& taken : taken_) {
        taken >>= by;
      }
    } else {
      std::fill(taken_.begin(), taken_.end(), 0);
    }
  }
  std::size_t of(std::uint64_t sector) const { return wrap_.of(sector); }
  Cycles base() const { return base_; }
  // Reserves the first free cycle of the sector's bank from base() + `ahead` on; returns how much
  // later than that it is. Throws InternalError if it is too far away.
  std::uint64_t take_from(std::uint64_t sector, std::uint64_t ahead) {
    std::uint64_t& taken = taken_[of(sector)];
    const std::uint64_t open = ahead < 64 ? ~taken >> ahead : 0;
    A2RT_CHECK(open != 0, "a bank was asked about a cycle it does not hold");
    const auto wait = static_cast<std::uint64_t>(std::countr_zero(open));
    taken |= std::uint64_t{1} << (ahead + wait);
    return wait;
  }
  // Reserves the cycle; false if it is taken. Throws InternalError if it is too far away.
  bool take(std::size_t bank, Cycles at) {
    const std::uint64_t ahead = at.value - base_.value;
    A2RT_CHECK(ahead < 64, "a bank was asked about a cycle it does not hold");
    const std::uint64_t bit = std::uint64_t{1} << ahead;
    const bool free = (taken_[bank] & bit) == 0;
    taken_[bank] |= bit;
    return free;
  }

 private:
  std::vector<std::uint64_t> taken_;  // bit i: cycle base_ + i
  Wrap wrap_;
  Cycles base_;
};

}  // namespace a2rt::timing
