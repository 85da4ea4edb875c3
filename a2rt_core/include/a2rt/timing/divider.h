// Division by a number known ahead, as a multiplication: a host takes a dozen cycles and more to
// divide.
#pragma once

#include <cstdint>

#include "a2rt/base/error.h"

namespace a2rt::timing {

class Divider {
 public:
  explicit Divider(std::uint64_t by = 1) : by_(by) {
    A2RT_CHECK(by > 0, "nothing can be divided by 0");
    // The inverse of 1 does not fit.
    exact_below_ = by > 1 ? ~std::uint64_t{0} / by : 0;
    inverse_ = ~std::uint64_t{0} / by + 1;
  }
  std::uint64_t by() const { return by_; }
  std::uint64_t quotient(std::uint64_t number) const {
    if (number < exact_below_) [[likely]] {
      return static_cast<std::uint64_t>(static_cast<unsigned __int128>(number) * inverse_ >> 64);
    }
    return number / by_;
  }
  struct Parts {
    std::uint64_t quotient, rest;
  };
  Parts divide(std::uint64_t number) const {
    const std::uint64_t q = quotient(number);
    return {q, number - q * by_};
  }

 private:
  std::uint64_t by_;
  std::uint64_t inverse_;      // 2^64 / by_, rounded up: too large by less than 1
  std::uint64_t exact_below_;  // so many times that is less than 1 / by_ of the quotient
};

}  // namespace a2rt::timing
