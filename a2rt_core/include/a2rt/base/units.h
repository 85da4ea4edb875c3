// Strong types for the quantities that must never be mixed: cycles, bytes, addresses.
#pragma once

#include <compare>
#include <cstdint>

namespace a2rt {

// A count of one kind of thing. Adding two different kinds does not compile.
template <class Tag>
struct Quantity {
  std::uint64_t value = 0;
  constexpr Quantity() = default;
  constexpr explicit Quantity(std::uint64_t v) : value(v) {}
  friend constexpr auto operator<=>(Quantity, Quantity) = default;
  constexpr Quantity& operator+=(Quantity o) {
    value += o.value;
    return *this;
  }
  friend constexpr Quantity operator+(Quantity a, Quantity b) {
    return Quantity{a.value + b.value};
  }
  friend constexpr Quantity operator-(Quantity a, Quantity b) {
    return Quantity{a.value - b.value};
  }
  friend constexpr Quantity operator*(Quantity a, std::uint64_t n) { return Quantity{a.value * n}; }
};

using Cycles = Quantity<struct CyclesTag>;  // of the clock domain named beside it
using Bytes = Quantity<struct BytesTag>;

// A byte address in the simulated GPU's memory.
struct Address {
  std::uint64_t value = 0;
  constexpr Address() = default;
  constexpr explicit Address(std::uint64_t v) : value(v) {}
  friend constexpr auto operator<=>(Address, Address) = default;
  friend constexpr Address operator+(Address a, Bytes b) { return Address{a.value + b.value}; }
  friend constexpr Bytes operator-(Address a, Address b) { return Bytes{a.value - b.value}; }
};

}  // namespace a2rt
