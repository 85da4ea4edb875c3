#include "a2rt/rt/a2rt_precision.h"

#include "a2rt/config/section.h"

namespace a2rt::rt {

arith::A2rtPrecision read_a2rt_precision(const config::Section& unit, arith::OriginDesign origin) {
  const config::Section s = unit.table("precision");
  arith::A2rtPrecision p;
  p.box_bits = static_cast<int>(s.integer("box_bits", 8, 4, 12, "bits", "Stored plane of a box"));
  p.origin = arith::origin_design_from(
      s.choice("origin", arith::name_of(origin), {"wide", "guard", "literal"},
               "Range of the quantized ray origin: wider integers, guard levels, or as printed"));
  p.origin_bits = static_cast<int>(
      s.integer("origin_bits", 0, 0, 16, "bits", "Signed origin of `wide`; 0: box_bits + 2"));
  p.direction = arith::float_format_from(
      s.text("direction", "bf16", "Format of 1/(d S): bf16, fp16, fp32 or s5..s10"));
  p.rounding = arith::quant_rounding_from(
      s.choice("rounding", "conservative", {"conservative", "nearest"}, "Of every quantity"));
  p.scales = arith::scale_sharing_from(s.choice(
      "scales", arith::name_of(arith::ScaleSharing::kPerAxis),
      {arith::name_of(arith::ScaleSharing::kPerAxis), arith::name_of(arith::ScaleSharing::kSingle)},
      "One scale per axis, or one for all"));
  p.multiplier_columns = static_cast<int>(s.integer("multiplier_columns", p.multiplier_columns, 0,
                                                    8, "columns", "Approximated low columns, k"));
  p.low_columns = arith::low_columns_from(s.choice(
      "low_columns", arith::name_of(p.low_columns),
      {arith::name_of(arith::LowColumns::kCompress), arith::name_of(arith::LowColumns::kDrop)},
      "What the multiplier does with its lowest columns"));
  p.validate("[precision]");
  return p;
}

arith::OriginDesign default_origin(const std::string& unit_name) {
  return unit_name == "a2rt-literal" ? arith::OriginDesign::kLiteral : arith::OriginDesign::kWide;
}

}  // namespace a2rt::rt
