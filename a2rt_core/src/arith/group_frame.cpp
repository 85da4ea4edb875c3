#include "a2rt/arith/group_frame.h"

#include <algorithm>
#include <cmath>

#include "a2rt/arith/directed.h"
#include "a2rt/base/error.h"
#include "box_check.h"

namespace a2rt::arith {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();

// A flat axis has no extent to derive a scale from. The finer it is, the shorter the stretch of ray
// that a level's uncertainty across the plane lets through along the others; too fine, and a far
// origin's FP32 error exceeds the origin's range. 16 halved the redundant hits of flat groups (1.5
// % to 0.8 % of true misses) without escapes up to 2^12 extents away; the guard design, with its
// one spare level, would escape on 5 % of those pairs and keeps 1.
float flat_axis_refinement(const A2rtPrecision& precision) {
  return precision.origin == OriginDesign::kWide ? 16 : 1;
}

float literal_scale(float lo, float hi, int steps) {
  const float scale = static_cast<float>(steps) / (hi - lo);
  return std::isfinite(scale) && scale > 0 ? scale : kLargest;
}

}  // namespace

float axis_scale(float lo, float hi, int steps) {
  if (lo == hi) {
    return 0;
  }
  // l <= extent: the FP64 difference (relative error 2^-53) stepped up once. Then steps/extent,
  // rounded in FP64 and down to FP32, may exceed steps/l only by the division's own rounding; that
  // is cut off by the second step. So S <= steps / l, that is l * S <= steps.
  const double infinity = std::numeric_limits<double>::infinity();
  double extent = static_cast<double>(hi) - static_cast<double>(lo);
  if (!mutant(Mutant::kScaleIgnoresExtentRounding)) {
    const ExactSum exact = two_sum(hi, -static_cast<double>(lo));
    extent = exact.error > 0 ? std::nextafter(exact.sum, infinity) : exact.sum;
  } else {
    extent = static_cast<double>(hi - lo);
  }
  const double quotient = steps / extent;
  if (mutant(Mutant::kScaleRoundsUp)) {
    return std::min(round_up(quotient), kLargest);
  }
  // fma tells exactly whether the quotient was rounded up.
  const bool above = std::fma(quotient, extent, -static_cast<double>(steps)) > 0;
  return round_down(quotient, above ? -1.0 : 0.0);
}

GroupFrame make_group_frame(const Box& box, const A2rtPrecision& precision,
                            const std::string& what) {
  require_finite_box(box, what);
  GroupFrame frame{box.lo, {}};
  float largest = 0;
  float smallest = kLargest;
  for (std::size_t a = 0; a < 3; ++a) {
    frame.scale[a] = axis_scale(box.lo[a], box.hi[a], precision.steps());
    if (precision.origin == OriginDesign::kLiteral && box.lo[a] != box.hi[a]) {
      frame.scale[a] = literal_scale(box.lo[a], box.hi[a], precision.steps());
    }
    if (frame.scale[a] > 0) {
      largest = std::max(largest, frame.scale[a]);
      smallest = std::min(smallest, frame.scale[a]);
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    if (largest == 0) {
      frame.scale[a] = 1;
    } else if (precision.scales == ScaleSharing::kSingle) {
      frame.scale[a] = smallest;
    } else if (frame.scale[a] == 0) {
      frame.scale[a] = std::min(largest * flat_axis_refinement(precision), kLargest);
    }
  }
  return frame;
}

}  // namespace a2rt::arith
