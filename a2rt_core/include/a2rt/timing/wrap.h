// Which of `n` sets or banks a number falls on. They are a power of two on every machine we know;
// others pay for a division.
#pragma once

#include <bit>
#include <cstdint>

namespace a2rt::timing {

class Wrap {
 public:
  explicit Wrap(std::uint64_t n = 1) : n_(n), mask_(std::has_single_bit(n) ? n - 1 : kNoMask) {}
  std::uint64_t of(std::uint64_t number) const {
    return mask_ != kNoMask ? number & mask_ : number % n_;
  }

 private:
  static constexpr std::uint64_t kNoMask = ~std::uint64_t{0};
  std::uint64_t n_, mask_;
};

}  // namespace a2rt::timing
