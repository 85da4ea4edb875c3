// Clock domains. The calendar counts core cycles; every other domain keeps its own count and is
// converted exactly, so that no domain drifts however long the run.
#pragma once

#include <cstdint>

#include "a2rt/base/error.h"
#include "a2rt/base/units.h"

namespace a2rt::timing {

// A clock of `mhz` beside the core clock of `core_mhz`. Both start with an edge at time 0.
class ClockDomain {
 public:
  ClockDomain() = default;
  ClockDomain(std::uint64_t mhz, std::uint64_t core_mhz) : mhz_(mhz), core_mhz_(core_mhz) {
    A2RT_CHECK(mhz > 0 && core_mhz > 0, "a clock needs a frequency above 0 MHz");
  }

  bool same() const { return mhz_ == core_mhz_; }
  // First edge of this domain at or after core cycle `core`, counted in this domain.
  Cycles from_core(Cycles core) const {
    return same() ? core : Cycles{ceil_div(core.value * mhz_, core_mhz_)};
  }
  // First edge of this domain that comes to the core in cycle `core` or later, as to_core() tells.
  // An edge between two core cycles is not lost by going there and back, unlike with from_core().
  Cycles seen_from(Cycles core) const {
    return same() || core == Cycles{0} ? core : Cycles{(core.value - 1) * mhz_ / core_mhz_ + 1};
  }
  // Core cycle in which this domain's edge `own` lies.
  Cycles core_of(Cycles own) const { return same() ? own : Cycles{own.value * core_mhz_ / mhz_}; }
  // First core edge at or after this domain's edge `own`.
  Cycles to_core(Cycles own) const {
    return same() ? own : Cycles{ceil_div(own.value * core_mhz_, mhz_)};
  }

 private:
  static std::uint64_t ceil_div(std::uint64_t a, std::uint64_t b) { return (a + b - 1) / b; }
  std::uint64_t mhz_ = 1, core_mhz_ = 1;
};

}  // namespace a2rt::timing
