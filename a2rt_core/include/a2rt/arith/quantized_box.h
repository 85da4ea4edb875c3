// Boxes of sub nodes in their group's integer coordinates.
//
// Conservative: q_lo = floor((x_lo - lo) S), q_hi = ceil((x_hi - lo) S) of the exact values (where
// x - lo does not fit FP64 - operands more than 2^29 apart - of a value at most one FP64 unit to
// the safe side), plus precision.offset(). Hence lo + (q_lo - offset)/S <= x_lo and x_hi <= lo +
// (q_hi - offset)/S in real arithmetic. Since the frame guarantees (hi - lo) S <= steps, every box
// inside the group fits.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "a2rt/arith/group_frame.h"

namespace a2rt::arith {

// Planes as stored, offset included; at most 12 bits used.
struct QuantizedBox {
  std::array<std::uint16_t, 3> lo{}, hi{};
  friend constexpr bool operator==(const QuantizedBox&, const QuantizedBox&) = default;
};

// Throws UserError naming `what` if the box is inverted, empty, not finite, or not inside the
// group.
QuantizedBox quantize_box(const Box& box, const Box& group, const GroupFrame& frame,
                          const A2rtPrecision& precision, const std::string& what = "sub node");

// The stored box in FP32, every plane rounded outwards (contains the exact dequantized box); planes
// beyond FP32 become +-FLT_MAX, which no finite geometry exceeds. Used when a pair escapes.
Box dequantize_box(const QuantizedBox& box, const GroupFrame& frame,
                   const A2rtPrecision& precision);

}  // namespace a2rt::arith
