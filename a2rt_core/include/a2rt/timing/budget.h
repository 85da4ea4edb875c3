// A port's bandwidth as a type: uses go out in order, at most `limit` in a cycle of its clock. A
// model that would send more than its hardware could stops with an error instead of printing a
// nicer figure.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "a2rt/base/error.h"
#include "a2rt/base/units.h"
#include "a2rt/timing/clock.h"

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
    A2RT_CHECK(at >= cycle_, "a port was used in the past");
    if (at != cycle_ || cycles_used_ == 0) {
      A2RT_CHECK(at >= following_, "a port was used between two cycles of its clock");
      cycle_ = at;
      following_ = std::max(at + Cycles{1}, clock_.to_core(clock_.from_core(at) + Cycles{1}));
      used_ = 0;
      ++cycles_used_;
    }
    A2RT_CHECK(used_ < limit_, "a port's bandwidth was overspent");
    ++used_;
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

// One access per cycle, reserved up to 63 cycles ahead: the reservations of a cache bank.
class Bank {
 public:
  // First cycle at or after `at` that is free. `now` only moves forward.
  Cycles next(Cycles now, Cycles at) {
    advance(now);
    const std::uint64_t ahead = at.value - base_.value;
    A2RT_CHECK(at >= now && ahead < 64, "a bank was asked about a cycle it does not hold");
    const std::uint64_t free = ~(taken_ >> ahead);
    return at + Cycles{static_cast<std::uint64_t>(std::countr_zero(free))};
  }
  // Throws InternalError if the cycle is taken or too far ahead.
  void take(Cycles at) {
    const std::uint64_t ahead = at.value - base_.value;
    A2RT_CHECK(ahead < 64, "a bank was reserved too far ahead");
    A2RT_CHECK((taken_ >> ahead & 1) == 0, "a bank was used twice in a cycle");
    taken_ |= std::uint64_t{1} << ahead;
  }

 private:
  void advance(Cycles now) {
    if (now > base_) {
      const std::uint64_t by = now.value - base_.value;
      taken_ = by < 64 ? taken_ >> by : 0;
      base_ = now;
    }
  }
  std::uint64_t taken_ = 0;  // bit i: cycle base_ + i
  Cycles base_;
};

}  // namespace a2rt::timing
