#include "a2rt/arith/aqb8_arith.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "a2rt/base/error.h"
#include "box_check.h"

namespace a2rt::arith {
namespace {

constexpr std::size_t kAxes = 3;
constexpr std::int32_t kIntMin = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kIntMax = std::numeric_limits<std::int32_t>::max();
constexpr float kTwo31 = 0x1p31F;
constexpr std::uint32_t kCopyMask = 0xFFF;  // 5-bit shift, 7-bit significand

float anchor_step(const Box& box, const Aqb8Precision& precision) {
  const float x = box.hi.x - box.lo.x;
  const float y = box.hi.y - box.lo.y;
  const float z = box.hi.z - box.lo.z;
  return std::max(std::max(x, y), z) / static_cast<float>(precision.levels());
}

bool usable_step(float sx) {
  const float inverse = 128.0F / sx;
  return sx > 0 && std::isfinite(sx) && inverse > 0 && std::isfinite(inverse);
}

std::int32_t to_int(float x, bool upper, Aqb8Rounding rounding) {
  if (rounding == Aqb8Rounding::kNearestEven) {
    return aqb8_nearest(x);
  }
  return upper ? aqb8_ceil(x) : aqb8_floor(x);
}

// C's fmax: a NaN operand is ignored.
float max3(float a, float b, float c, float d) {
  return std::fmax(std::fmax(a, b), std::fmax(c, d));
}
float min3(float a, float b, float c, float d) {
  return std::fmin(std::fmin(a, b), std::fmin(c, d));
}

std::uint32_t shifted(std::uint32_t copy, std::uint32_t plane) {
  return ((128U + (copy & 127U)) * plane) << (copy >> 7 & 31U);
}

}  // namespace

std::int32_t aqb8_floor(float x) {
  if (std::isnan(x) || x < -kTwo31) {
    return kIntMin;
  }
  return x >= kTwo31 ? kIntMax : static_cast<std::int32_t>(std::floor(x));
}

std::int32_t aqb8_ceil(float x) {
  // Exactly 2^31 passes the artifact's "> 2^31" guard and its conversion yields INT32_MIN on x86.
  if (std::isnan(x) || x <= -kTwo31 || x == kTwo31) {
    return kIntMin;
  }
  return x > kTwo31 ? kIntMax : static_cast<std::int32_t>(std::ceil(x));
}

std::int32_t aqb8_nearest(float x) {
  if (std::isnan(x)) {
    return kIntMin;
  }
  if (x >= kTwo31) {
    return kIntMax;
  }
  return x < -kTwo31 ? kIntMin : static_cast<std::int32_t>(std::nearbyint(x));
}

bool aqb8_can_anchor(const Box& box, const Aqb8Precision& precision) {
  return box.valid() && usable_step(anchor_step(box, precision));
}

Aqb8Anchor make_aqb8_anchor(const Box& box, const std::string& what,
                            const Aqb8Precision& precision) {
  require_finite_box(box, what);
  const float sx = anchor_step(box, precision);
  if (!usable_step(sx)) {
    throw UserError(
        what + ": AQB8 cannot anchor this box (largest extent / levels = " + std::to_string(sx) +
        "); its step or the step's inverse is zero or infinite. "
        "Keep the node in its parent's cluster");
  }
  return {box, 128.0F / sx, sx, precision.levels()};
}

Aqb8Box quantize_aqb8(const Box& box, const Aqb8Anchor& anchor, const std::string& what) {
  require_finite_box(box, what);
  Aqb8Box q;
  for (std::size_t a = 0; a < kAxes; ++a) {
    const float low = anchor.box.lo[a];
    const std::int32_t lo = aqb8_floor((box.lo[a] - low) / anchor.sx);
    const std::int32_t hi = aqb8_ceil((box.hi[a] - low) / anchor.sx);
    if (lo < 0 || hi > anchor.levels + 1) {
      throw UserError(what + ": box leaves its AQB8 anchor on axis " + std::to_string(a) + " (" +
                      std::to_string(lo) + " to " + std::to_string(hi) + " of 0 to " +
                      std::to_string(anchor.levels + 1) + "); rebuild or refit the tree");
    }
    q.lo[a] = static_cast<std::uint8_t>(std::min(lo, anchor.levels));
    q.hi[a] = static_cast<std::uint8_t>(std::min(hi, anchor.levels));
  }
  return q;
}

Box dequantize_aqb8(const Aqb8Box& box, const Aqb8Anchor& anchor) {
  Box out;
  for (std::size_t a = 0; a < kAxes; ++a) {
    out.lo[a] = anchor.box.lo[a] + anchor.sx * static_cast<float>(box.lo[a]);
    out.hi[a] = anchor.box.lo[a] + anchor.sx * static_cast<float>(box.hi[a]);
  }
  return out;
}

float aqb8_half_area(const Aqb8Box& box, const Aqb8Anchor& anchor) {
  const Box b = dequantize_aqb8(box, anchor);
  const float dx = b.hi.x - b.lo.x;
  const float dy = b.hi.y - b.lo.y;
  const float dz = b.hi.z - b.lo.z;
  return (dx + dy) * dz + dx * dy;
}

Aqb8Ray make_aqb8_ray(const Vec3& origin, const Vec3& direction, float tmin,
                      const Aqb8Precision& precision) {
  Aqb8Ray ray;
  const std::uint32_t step = 1U << (8 - precision.slope_bits);
  ray.tmin = tmin;
  for (std::size_t a = 0; a < kAxes; ++a) {
    ray.w[a] = 1.0F / direction[a];
    ray.b[a] = -origin[a] * ray.w[a];
    const auto bits = std::bit_cast<std::uint32_t>(ray.w[a]);
    const std::uint32_t shift = ((bits >> 23 & 0xFFU) - 127U) & 31U;
    const std::uint32_t near = shift << 7 | (bits >> 16 & 127U & ~(step - 1));
    const std::uint32_t far = (near + step) & kCopyMask;
    const bool negative = (bits >> 31) != 0;
    ray.negative |= static_cast<std::uint8_t>(negative ? 1U << a : 0U);
    ray.low[a] = static_cast<std::uint16_t>(negative ? far : near);
    ray.high[a] = static_cast<std::uint16_t>(negative ? near : far);
  }
  return ray;
}

Aqb8Entry aqb8_anchor_test(const Aqb8Ray& ray, const Aqb8Anchor& anchor, float tmax) {
  float entry[kAxes];
  float exit[kAxes];
  for (std::size_t a = 0; a < kAxes; ++a) {
    const bool negative = (ray.negative >> a & 1U) != 0;
    const float first = negative ? anchor.box.hi[a] : anchor.box.lo[a];
    const float second = negative ? anchor.box.lo[a] : anchor.box.hi[a];
    entry[a] = ray.w[a] * first + ray.b[a];
    exit[a] = ray.w[a] * second + ray.b[a];
  }
  const float in = max3(entry[0], entry[1], entry[2], ray.tmin);
  const float out = min3(exit[0], exit[1], exit[2], tmax);
  return {in <= out, in};
}

std::int32_t aqb8_qy_max(const Aqb8Anchor& anchor, float y_ref, float tmax, Aqb8Rounding rounding) {
  return to_int((tmax - y_ref) * anchor.inv_sx_inv_sw, true, rounding);
}

Aqb8Local aqb8_enter(const Aqb8Ray& ray, const Aqb8Anchor& anchor, float y_ref, float tmax,
                     Aqb8Rounding rounding) {
  Aqb8Local local;
  local.y_ref = y_ref;
  for (std::size_t a = 0; a < kAxes; ++a) {
    const float at = (ray.b[a] - y_ref) + anchor.box.lo[a] * ray.w[a];
    local.low[a] = to_int(at * anchor.inv_sx_inv_sw, false, rounding);
    // int32 increment without saturation: INT32_MAX wraps to INT32_MIN.
    local.high[a] = static_cast<std::int32_t>(static_cast<std::uint32_t>(local.low[a]) + 1U);
  }
  local.qy_max = aqb8_qy_max(anchor, y_ref, tmax, rounding);
  return local;
}

Aqb8Hit aqb8_test(const Aqb8Ray& ray, const Aqb8Local& local, const Aqb8Box& box) {
  std::int32_t in = 0;
  std::int32_t out = local.qy_max;
  for (std::size_t a = 0; a < kAxes; ++a) {
    const bool negative = (ray.negative >> a & 1U) != 0;
    std::uint32_t first = shifted(ray.low[a], negative ? box.hi[a] : box.lo[a]);
    std::uint32_t second = shifted(ray.high[a], negative ? box.lo[a] : box.hi[a]);
    if (negative) {
      first = 0U - first;
      second = 0U - second;
    }
    const std::uint32_t entry = first + static_cast<std::uint32_t>(local.low[a]);
    const std::uint32_t exit = second + static_cast<std::uint32_t>(local.high[a]);
    in = std::max(in, static_cast<std::int32_t>(entry));
    out = std::min(out, static_cast<std::int32_t>(exit));
  }
  return {in <= out, in};
}

}  // namespace a2rt::arith
