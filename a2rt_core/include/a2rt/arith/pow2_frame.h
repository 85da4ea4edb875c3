// Frames with power-of-two scales: compressed wide BVHs and compressed leaves.
//
// Sources: Ylitie, Karras, Laine, "Efficient incoherent ray traversal on GPUs through compressed
// wide BVHs", HPG 2017, section 3 (per node an FP32 corner and an 8-bit exponent per axis, children
// 8 bits per plane); Benthin, Wald, Woop, Afra, "Compressed-leaf bounding volume hierarchies", HPG
// 2018 (the same idea at the leaves). Both dequantize to FP32 before an FP32 test.
//
// Grid: plane = lo + q * 2^e, q = 0..255. e is the smallest integer with 255 * 2^e >= hi - lo
// (exact), at least -126, so that e + 127 is the exponent byte of an FP32 number (e <= 122 always,
// because an extent is below 2^129 < 255 * 2^122). Children: q_lo = floor, q_hi = ceil of
// (x - lo) / 2^e, exact. Dequantization rounds outwards, so the FP32 box contains the child.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "a2rt/base/vec.h"

namespace a2rt::arith {

struct Pow2Frame {
  Vec3 lo;
  std::array<std::int8_t, 3> exponent{};  // step = 2^exponent
  friend constexpr bool operator==(const Pow2Frame&, const Pow2Frame&) = default;
};

struct Pow2Box {
  std::array<std::uint8_t, 3> lo{}, hi{};
  friend constexpr bool operator==(const Pow2Box&, const Pow2Box&) = default;
};

// Throws UserError naming `what` if the box is inverted, empty or not finite.
Pow2Frame make_pow2_frame(const Box& box, const std::string& what = "node");
// Throws UserError if the box is inverted, empty, not finite or not inside the frame's parent.
Pow2Box quantize_pow2(const Box& box, const Pow2Frame& frame, const std::string& what = "child");
// FP32 box that contains the grid box; planes beyond FP32 become +-FLT_MAX.
Box dequantize_pow2(const Pow2Box& box, const Pow2Frame& frame);

}  // namespace a2rt::arith
