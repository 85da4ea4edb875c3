#include "a2rt/arith/quantized_box.h"

#include <algorithm>
#include <cmath>

#include "a2rt/arith/directed.h"
#include "a2rt/base/error.h"
#include "box_check.h"

namespace a2rt::arith {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();
constexpr const char* kAxisNames[3] = {"x", "y", "z"};

// floor(v), without a call where v fits an integer; |v| is at most a few thousand for boxes inside
// their group.
double floor_level(double v) {
  if (!(std::fabs(v) < 0x1p30)) [[unlikely]] {
    return std::floor(v);
  }
  const auto truncated = static_cast<double>(static_cast<int>(v));
  return truncated > v ? truncated - 1 : truncated;
}

// floor((x - lo) * S), exact if x - lo fits FP64, else of a value at most one FP64 unit below.
// With y = x - lo and v = RN(y S): if v is not an integer, the integer below v is also below y S
// and the next one above it, because RN is monotone and integers are FP64 numbers. If v is an
// integer, the residual y S - v, exact by fma, decides.
double floor_scaled(float x, float lo, float scale) {
  const ExactSum d = two_sum(x, -static_cast<double>(lo));
  const double y = d.error < 0 && !mutant(Mutant::kBoxResidualIgnored)
                       ? std::nextafter(d.sum, -std::numeric_limits<double>::infinity())
                       : d.sum;
  const double v = y * scale;
  const double below = floor_level(v);
  if (below != v || mutant(Mutant::kBoxResidualIgnored)) {
    return below;
  }
  return std::fma(y, scale, -v) < 0 ? below - 1 : below;
}

// ceil((x - lo) * S), mirrored.
double ceil_scaled(float x, float lo, float scale) { return -floor_scaled(-x, -lo, scale); }

std::uint16_t stored(double level, const A2rtPrecision& precision) {
  return static_cast<std::uint16_t>(static_cast<int>(level) + precision.offset());
}

// The paper's formula in plain FP32.
std::uint16_t literal_level(float x, float lo, float scale, bool upper,
                            const A2rtPrecision& precision) {
  const float v = (x - lo) * scale;
  const float level = upper ? std::ceil(v) : std::floor(v);
  return stored(std::clamp(level, 0.0F, static_cast<float>(precision.steps())), precision);
}

}  // namespace

void require_finite_box(const Box& box, const std::string& what) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(box.lo[a] <= box.hi[a]) || !std::isfinite(box.lo[a]) || !std::isfinite(box.hi[a])) {
      throw UserError(what + ": box is empty, inverted or not finite on the " + kAxisNames[a] +
                      " axis (" + std::to_string(box.lo[a]) + " to " + std::to_string(box.hi[a]) +
                      "); drop inactive primitives before building the tree");
    }
  }
}

void require_inside(const Box& box, const Box& outer, const std::string& what) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (box.lo[a] < outer.lo[a] || box.hi[a] > outer.hi[a]) {
      throw UserError(what + ": box leaves its parent on the " + kAxisNames[a] + " axis (" +
                      std::to_string(box.lo[a]) + " to " + std::to_string(box.hi[a]) + " outside " +
                      std::to_string(outer.lo[a]) + " to " + std::to_string(outer.hi[a]) +
                      "); rebuild or refit the tree");
    }
  }
}

QuantizedBox quantize_box(const Box& box, const Box& group, const GroupFrame& frame,
                          const A2rtPrecision& precision, const std::string& what) {
  require_finite_box(box, what);
  require_inside(box, group, what);
  QuantizedBox q;
  const double steps = precision.steps();
  for (std::size_t a = 0; a < 3; ++a) {
    const float lo = frame.lo[a];
    const float scale = frame.scale[a];
    if (precision.origin == OriginDesign::kLiteral) {
      q.lo[a] = literal_level(box.lo[a], lo, scale, false, precision);
      q.hi[a] = literal_level(box.hi[a], lo, scale, true, precision);
      continue;
    }
    if (precision.rounding == QuantRounding::kNearest) {
      const auto nearest = [&](float x) {
        const double v = (static_cast<double>(x) - static_cast<double>(lo)) * scale;
        return std::clamp(std::nearbyint(v), 0.0, steps);
      };
      q.lo[a] = stored(nearest(box.lo[a]), precision);
      q.hi[a] = stored(nearest(box.hi[a]), precision);
      continue;
    }
    // Inside the group 0 <= (x - lo) S <= steps exactly, so clamping only undoes the one-unit
    // margin taken when x - lo does not fit FP64.
    double below = floor_scaled(box.lo[a], lo, scale);
    double above = ceil_scaled(box.hi[a], lo, scale);
    if (mutant(Mutant::kBoxLoCeil)) {
      below = std::ceil((static_cast<double>(box.lo[a]) - lo) * scale);
    }
    if (mutant(Mutant::kBoxHiFloor)) {
      above = std::floor((static_cast<double>(box.hi[a]) - lo) * scale);
    }
    q.lo[a] = stored(std::clamp(below, 0.0, steps), precision);
    q.hi[a] = stored(std::clamp(above, 0.0, steps), precision);
    if (mutant(Mutant::kGuardOffsetForgotten) && precision.offset() != 0) {
      q.lo[a] = static_cast<std::uint16_t>(q.lo[a] - precision.offset());
      q.hi[a] = static_cast<std::uint16_t>(q.hi[a] - precision.offset());
    }
  }
  return q;
}

Box dequantize_box(const QuantizedBox& box, const GroupFrame& frame,
                   const A2rtPrecision& precision) {
  // k/S has relative error 2^-53; widening it by 2^-52 bounds the exact value, and the FP64 sum
  // with lo is turned into FP32 with its exact residual.
  constexpr double kWiden = 0x1p-52;
  Box out;
  for (std::size_t a = 0; a < 3; ++a) {
    const double lo_step = (box.lo[a] - precision.offset()) / static_cast<double>(frame.scale[a]);
    const double hi_step = (box.hi[a] - precision.offset()) / static_cast<double>(frame.scale[a]);
    const ExactSum lo = two_sum(frame.lo[a], lo_step - std::fabs(lo_step) * kWiden);
    const ExactSum hi = two_sum(frame.lo[a], hi_step + std::fabs(hi_step) * kWiden);
    out.lo[a] = std::max(round_down(lo.sum, lo.error), -kLargest);
    out.hi[a] = std::min(round_up(hi.sum, hi.error), kLargest);
    if (mutant(Mutant::kDequantizeNearest)) {
      out.lo[a] = static_cast<float>(lo.sum);
      out.hi[a] = static_cast<float>(hi.sum);
    }
  }
  return out;
}

}  // namespace a2rt::arith
