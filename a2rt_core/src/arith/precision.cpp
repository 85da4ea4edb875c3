#include "a2rt/arith/precision.h"

#include <array>
#include <string_view>
#include <utility>

#include "a2rt/base/error.h"

namespace a2rt::arith {
namespace {

// Keeps |plane - origin| within 14 bits, so that its product with 10 significand bits is exact in
// FP32 (the vector kernel relies on it).
constexpr int kMostOriginBits = 14;

template <class Value, std::size_t N>
using Names = std::array<std::pair<std::string_view, Value>, N>;

constexpr Names<OriginDesign, 3> kOrigins{{{"wide", OriginDesign::kWide},
                                           {"guard", OriginDesign::kGuard},
                                           {"literal", OriginDesign::kLiteral}}};
constexpr Names<QuantRounding, 2> kRoundings{
    {{"conservative", QuantRounding::kConservative}, {"nearest", QuantRounding::kNearest}}};
constexpr Names<ScaleSharing, 2> kScales{
    {{"per_axis", ScaleSharing::kPerAxis}, {"single", ScaleSharing::kSingle}}};
constexpr Names<LowColumns, 2> kColumns{
    {{"compress", LowColumns::kCompress}, {"drop", LowColumns::kDrop}}};
constexpr Names<FloatFormat, 9> kFormats{{{"bf16", kBf16},
                                          {"fp16", kFp16},
                                          {"fp32", kFp32},
                                          {"s5", reduced_significand(5)},
                                          {"s6", reduced_significand(6)},
                                          {"s7", reduced_significand(7)},
                                          {"s8", reduced_significand(8)},
                                          {"s9", reduced_significand(9)},
                                          {"s10", reduced_significand(10)}}};

template <class Value, std::size_t N>
Value find_value(const Names<Value, N>& names, const std::string& name, const char* what) {
  std::string known;
  for (const auto& [text, value] : names) {
    if (text == name) {
      return value;
    }
    known += (known.empty() ? "" : ", ") + std::string(text);
  }
  throw UserError(std::string(what) + " '" + name + "' is not known; use one of: " + known);
}

template <class Value, std::size_t N>
std::string find_name(const Names<Value, N>& names, Value value) {
  for (const auto& [text, known] : names) {
    if (known == value) {
      return std::string(text);
    }
  }
  return "unnamed";
}

void require(bool fine, const std::string& where, const std::string& knob, int value,
             const std::string& allowed) {
  if (!fine) {
    throw UserError(where + ": " + knob + " = " + std::to_string(value) + " is not possible; use " +
                    allowed);
  }
}

}  // namespace

void A2rtPrecision::validate(const std::string& where) const {
  require(box_bits >= 4 && box_bits <= 12, where, "box_bits", box_bits, "4 to 12");
  if (origin == OriginDesign::kWide) {
    require(origin_bits == 0 || (origin_bits > box_bits && origin_bits <= kMostOriginBits), where,
            "origin_bits", origin_bits,
            "0 (box_bits + 2) or " + std::to_string(box_bits + 1) + " to " +
                std::to_string(kMostOriginBits));
  } else {
    require(origin_bits == 0 || origin_bits == box_bits, where, "origin_bits", origin_bits,
            "0 or box_bits (only the wide design has its own origin width)");
  }
  require(multiplier_columns >= 0 && multiplier_columns <= 8, where, "multiplier_columns",
          multiplier_columns, "0 to 8");
  if (find_name(kFormats, direction) == "unnamed") {
    throw UserError(where + ": direction format with " + std::to_string(direction.exponent_bits) +
                    " exponent and " + std::to_string(direction.significand_bits) +
                    " significand bits is not possible; use bf16, fp16, fp32 or s5 to s10");
  }
}

OriginDesign origin_design_from(const std::string& name) {
  return find_value(kOrigins, name, "origin design");
}
std::string name_of(OriginDesign design) { return find_name(kOrigins, design); }
QuantRounding quant_rounding_from(const std::string& name) {
  return find_value(kRoundings, name, "rounding");
}
std::string name_of(QuantRounding rounding) { return find_name(kRoundings, rounding); }
ScaleSharing scale_sharing_from(const std::string& name) {
  return find_value(kScales, name, "scale sharing");
}
std::string name_of(ScaleSharing scales) { return find_name(kScales, scales); }
LowColumns low_columns_from(const std::string& name) {
  return find_value(kColumns, name, "low columns");
}
std::string name_of(LowColumns columns) { return find_name(kColumns, columns); }
FloatFormat float_format_from(const std::string& name) {
  return find_value(kFormats, name, "direction format");
}
std::string name_of(FloatFormat format) { return find_name(kFormats, format); }

}  // namespace a2rt::arith
