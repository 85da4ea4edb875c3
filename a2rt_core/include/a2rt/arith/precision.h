// Every precision choice of the A2RT unit in one place (the knobs of the accuracy price list).
#pragma once

#include <cstdint>
#include <string>

#include "a2rt/arith/small_float.h"

namespace a2rt::arith {

// How the local ray origin is kept when it leaves the range of the boxes' integers.
enum class OriginDesign : std::uint8_t {
  kWide,     // 2^b - 1 steps, origin in a wider signed integer; outside it the pair escapes
  kGuard,    // 2^b - 3 steps, one guard level on each side, origin as wide as the boxes
  kLiteral,  // as printed in the paper: plain FP32, origin clamped to b bits; can miss hits
};

// Conservative rounds each quantity to its safe side; nearest rounds everything to nearest and can
// miss hits.
enum class QuantRounding : std::uint8_t { kConservative, kNearest };

enum class ScaleSharing : std::uint8_t { kPerAxis, kSingle };

// What the approximate multiplier does with its lowest columns; see multiplier.h.
enum class LowColumns : std::uint8_t { kCompress, kDrop };

struct A2rtPrecision {
  int box_bits = 8;  // 4..12 bits per stored plane
  OriginDesign origin = OriginDesign::kWide;
  int origin_bits = 0;            // wide only: signed bits; 0 means box_bits + 2
  FloatFormat direction = kBf16;  // of 1/(d S), of the products and of the remaining t
  QuantRounding rounding = QuantRounding::kConservative;
  ScaleSharing scales = ScaleSharing::kPerAxis;
  int multiplier_columns = 4;  // k, 0 (exact) to 8
  LowColumns low_columns = LowColumns::kCompress;

  // Largest integer a stored plane may have.
  constexpr int max_level() const { return (1 << box_bits) - 1; }
  // Levels that span the group's extent.
  constexpr int steps() const { return max_level() - (origin == OriginDesign::kGuard ? 2 : 0); }
  // Integer at which the group's low plane is stored.
  constexpr int offset() const { return origin == OriginDesign::kGuard ? 1 : 0; }
  constexpr int effective_origin_bits() const {
    return origin != OriginDesign::kWide ? box_bits : origin_bits == 0 ? box_bits + 2 : origin_bits;
  }
  constexpr int min_origin() const {
    return origin == OriginDesign::kWide ? -(1 << (effective_origin_bits() - 1)) : 0;
  }
  constexpr int max_origin() const {
    return origin == OriginDesign::kWide ? (1 << (effective_origin_bits() - 1)) - 1 : max_level();
  }
  // Bits of the largest |plane - origin|: the multiplier's integer operand.
  constexpr int magnitude_bits() const {
    const int below = max_level() - min_origin();
    const int most = below > max_origin() ? below : max_origin();
    int bits = 0;
    while ((most >> bits) != 0) {
      ++bits;
    }
    return bits;
  }
  // True if the guarantee of no missed hit holds.
  constexpr bool conservative() const {
    return origin != OriginDesign::kLiteral && rounding == QuantRounding::kConservative;
  }

  // Throws UserError naming the knob, its value and the allowed range. `where` prefixes the message
  // (for example the file of the unit's configuration).
  void validate(const std::string& where = "a2rt precision") const;

  friend constexpr bool operator==(const A2rtPrecision&, const A2rtPrecision&) = default;
};

// Names used in configuration files and reports. The from_ functions throw UserError listing the
// known names; formats are "bf16", "fp16", "fp32" and "s5".."s10" (significand bits with BF16's
// exponent).
OriginDesign origin_design_from(const std::string& name);
std::string name_of(OriginDesign design);
QuantRounding quant_rounding_from(const std::string& name);
std::string name_of(QuantRounding rounding);
ScaleSharing scale_sharing_from(const std::string& name);
std::string name_of(ScaleSharing scales);
LowColumns low_columns_from(const std::string& name);
std::string name_of(LowColumns columns);
FloatFormat float_format_from(const std::string& name);
std::string name_of(FloatFormat format);

}  // namespace a2rt::arith
