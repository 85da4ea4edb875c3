// Masks in which each bit stands for one of a few things: lanes, sectors, slots.
#pragma once

#include <bit>
#include <cstdint>

namespace a2rt {

// Calls f(i) for each bit i that is set, ascending.
template <class F>
constexpr void for_each_bit(std::uint32_t mask, const F& f) {
  for (; mask != 0; mask &= mask - 1) {
    f(static_cast<std::uint32_t>(std::countr_zero(mask)));
  }
}

}  // namespace a2rt
