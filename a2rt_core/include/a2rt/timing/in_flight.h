#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/base/units.h"

namespace a2rt::timing {

// How many things can be under way at once, such as MSHRs: one more begins when the one that is so
// many before it has ended.
class InFlight {
 public:
  explicit InFlight(std::uint32_t limit) : ends_(limit) {
    A2RT_CHECK(limit > 0, "something that must pass has no room");
  }
  // When `n` more can be under way, if they want to be at `wanted`.
  Cycles begin(Cycles wanted, std::uint32_t n) const {
    return std::max(wanted, ends_[wrapped(next_ + std::min<std::size_t>(n, ends_.size()) - 1)]);
  }
  // So many begin, and end at `end`.
  void add(std::uint32_t n, Cycles end) {
    for (; n > 0; --n) {
      ends_[next_] = end;
      next_ = wrapped(next_ + 1);
    }
  }

 private:
  std::size_t wrapped(std::size_t i) const { return i < ends_.size() ? i : i - ends_.size(); }
  std::vector<Cycles> ends_;  // of the last ones
  std::size_t next_ = 0;
};

}  // namespace a2rt::timing
