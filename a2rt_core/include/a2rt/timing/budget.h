// A per-cycle budget that throws when overspent: a model that issues more than its hardware could
// stops with an error instead of printing a nicer figure.
#pragma once

#include <cstdint>

#include "a2rt/base/error.h"
#include "a2rt/base/units.h"

namespace a2rt::timing {

// `limit` uses per cycle of whatever it guards (sectors of a port, issues of a scheduler).
class Budget {
 public:
  explicit Budget(std::uint32_t limit) : limit_(limit) {
    A2RT_CHECK(limit > 0, "a budget of 0 per cycle would never let anything pass");
  }
  std::uint32_t left(Cycles now) const { return now == cycle_ ? limit_ - used_ : limit_; }
  // Throws InternalError if more than the limit is spent in one cycle, or if time runs backwards.
  void spend(Cycles now, std::uint32_t amount = 1) {
    A2RT_CHECK(now >= cycle_, "a budget was spent in the past");
    if (now != cycle_) {
      cycle_ = now;
      used_ = 0;
    }
    A2RT_CHECK(amount <= limit_ - used_, "a per-cycle budget was overspent");
    used_ += amount;
  }

 private:
  std::uint32_t limit_;
  std::uint32_t used_ = 0;
  Cycles cycle_;
};

}  // namespace a2rt::timing
