// The rational half of the oracle. Kept apart because GMP's C++ front end compiles slowly.
#include <boost/multiprecision/gmp.hpp>
#include <cmath>
#include <limits>
#include <optional>

#include "a2rt/arith/oracle.h"

namespace a2rt::arith {
namespace {

using Rational = boost::multiprecision::mpq_rational;

constexpr std::size_t kAxes = 3;

Rational exact(double x) { return Rational(x); }

// First and last time in the box's slabs from tmin on; empty if there is none.
struct Span {
  Rational first;
  std::optional<Rational> last;  // no value: unbounded
};

std::optional<Span> span_in_box(const OracleRay& ray, const Box& box, float tmax) {
  Span span{exact(ray.tmin), std::nullopt};
  if (!std::isinf(tmax)) {
    span.last = exact(tmax);
  }
  for (std::size_t a = 0; a < kAxes; ++a) {
    const Rational o = exact(ray.origin[a]);
    const Rational lo = exact(box.lo[a]);
    const Rational hi = exact(box.hi[a]);
    if (ray.dir[a] == 0) {
      if (o < lo || o > hi) {
        return std::nullopt;
      }
      continue;
    }
    const Rational d = exact(ray.dir[a]);
    const Rational near = ((d < 0 ? hi : lo) - o) / d;
    const Rational far = ((d < 0 ? lo : hi) - o) / d;
    if (near > span.first) {
      span.first = near;
    }
    if (!span.last || far < *span.last) {
      span.last = far;
    }
  }
  if (span.last && span.first > *span.last) {
    return std::nullopt;
  }
  return span;
}

Rational dequantized(int level, std::size_t axis, const GroupFrame& frame,
                     const A2rtPrecision& precision) {
  return exact(frame.lo[axis]) + Rational(level - precision.offset()) / exact(frame.scale[axis]);
}

}  // namespace

bool ray_meets_box_rational(const OracleRay& ray, const Box& box, float tmax) {
  return span_in_box(ray, box, tmax).has_value();
}

bool scale_is_safe(const Box& group, const GroupFrame& frame, const A2rtPrecision& precision) {
  for (std::size_t a = 0; a < kAxes; ++a) {
    const Rational levels = (exact(group.hi[a]) - exact(group.lo[a])) * exact(frame.scale[a]);
    if (!(std::isfinite(frame.scale[a]) && frame.scale[a] > 0) || levels > precision.steps()) {
      return false;
    }
  }
  return true;
}

bool box_is_contained(const Box& box, const QuantizedBox& stored, const GroupFrame& frame,
                      const A2rtPrecision& precision) {
  for (std::size_t a = 0; a < kAxes; ++a) {
    if (stored.hi[a] > precision.max_level() || stored.lo[a] > stored.hi[a] ||
        dequantized(stored.lo[a], a, frame, precision) > exact(box.lo[a]) ||
        dequantized(stored.hi[a], a, frame, precision) < exact(box.hi[a])) {
      return false;
    }
  }
  return true;
}

bool dequantized_is_contained(const QuantizedBox& stored, const Box& fp32, const GroupFrame& frame,
                              const A2rtPrecision& precision) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  for (std::size_t a = 0; a < kAxes; ++a) {
    // Planes beyond FP32 are capped; no finite geometry lies there.
    const bool low = fp32.lo[a] == -kLargest ||
                     exact(fp32.lo[a]) <= dequantized(stored.lo[a], a, frame, precision);
    const bool high = fp32.hi[a] == kLargest ||
                      exact(fp32.hi[a]) >= dequantized(stored.hi[a], a, frame, precision);
    if (!low || !high) {
      return false;
    }
  }
  return true;
}

bool shift_is_early(const OracleRay& ray, const Box& box, float t_shift) {
  const std::optional<Span> span = span_in_box(ray, box, std::numeric_limits<float>::infinity());
  return static_cast<double>(t_shift) >= ray.tmin && (!span || exact(t_shift) <= span->first);
}

bool origin_is_contained(const QuantizerRay& ray, const GroupFrame& frame, const GroupRay& local,
                         const A2rtPrecision& precision) {
  for (std::size_t a = 0; a < kAxes; ++a) {
    const Rational point = exact(ray.origin[a]) + exact(local.t_shift) * exact(ray.dir[a]);
    const Rational c =
        (point - exact(frame.lo[a])) * exact(frame.scale[a]) + Rational(precision.offset());
    const bool negative = ray.dir[a] < 0;
    const float low = negative ? local.near_origin[a] : local.far_origin[a];
    const float high = negative ? local.far_origin[a] : local.near_origin[a];
    if (exact(low) > c || exact(high) < c || low < static_cast<float>(precision.min_origin()) ||
        high > static_cast<float>(precision.max_origin())) {
      return false;
    }
  }
  return true;
}

bool rates_are_contained(const QuantizerRay& ray, const GroupFrame& frame, const GroupRay& local) {
  for (std::size_t a = 0; a < kAxes; ++a) {
    const float near = std::fabs(local.near_rate[a]);
    const float far = std::fabs(local.far_rate[a]);
    if (ray.dir[a] == 0) {
      if (!std::isinf(near) || !std::isinf(far)) {
        return false;
      }
      continue;
    }
    const Rational inverse = 1 / (abs(exact(ray.dir[a])) * exact(frame.scale[a]));
    if (std::isinf(near) || exact(near) > inverse || (!std::isinf(far) && exact(far) < inverse)) {
      return false;
    }
  }
  return true;
}

bool remaining_is_late(float remaining, float t_closest, float t_shift, float largest) {
  if (remaining == largest) {
    return true;
  }
  return !std::isinf(t_closest) && exact(remaining) >= exact(t_closest) - exact(t_shift);
}

}  // namespace a2rt::arith
