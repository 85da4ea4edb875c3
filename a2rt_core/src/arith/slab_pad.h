// Padding constants of the FP32 slab test, proved in slab.h; shared by scalar and vector code.
#pragma once

namespace a2rt::arith {

inline constexpr float kNearPad = 1 - 0x1p-22F;            // 1 - 4u
inline constexpr float kFarPad = 1 + 0x1p-22F + 0x1p-23F;  // 1 + 6u
inline constexpr float kAbsolutePad = 0x1p-120F;           // normal, to avoid denormal operands

}  // namespace a2rt::arith
