#include "a2rt/arith/slab.h"

#include <algorithm>
#include <cmath>

#include "a2rt/arith/directed.h"
#include "slab_pad.h"

namespace a2rt::arith {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kAxes = 3;

// Same operand order as the vector instructions: a NaN first operand yields the second.
float max_second(float a, float b) { return a > b ? a : b; }
float min_second(float a, float b) { return a < b ? a : b; }

struct PlaneTimes {
  float near, far;
};

PlaneTimes unpadded_times(const SlabRay& ray, const Box& box) {
  PlaneTimes t{-kInfinity, kInfinity};
  for (std::size_t a = 0; a < kAxes; ++a) {
    const bool negative = (ray.negative >> a & 1U) != 0;
    const float near = ((negative ? box.hi[a] : box.lo[a]) - ray.origin[a]) * ray.rcp[a];
    const float far = ((negative ? box.lo[a] : box.hi[a]) - ray.origin[a]) * ray.rcp[a];
    if (mutant(Mutant::kSlabParallelDropsFace) && (std::isnan(near) || std::isnan(far))) {
      return {kInfinity, -kInfinity};
    }
    t.near = max_second(near, t.near);
    t.far = min_second(far, t.far);
  }
  return t;
}

SlabHit slab_test_regular(const SlabRay& ray, const Box& box, float tmax) {
  const PlaneTimes t = unpadded_times(ray, box);
  float near = mutant(Mutant::kSlabNearOverflowStays) ? t.near : min_second(t.near, kLargestFloat);
  near = near * kNearPad - kAbsolutePad;
  if (mutant(Mutant::kShiftNotPadded)) {
    near = t.near;
  }
  float far = t.far * kFarPad + kAbsolutePad;
  if (mutant(Mutant::kSlabFarNotPadded)) {
    far = t.far;
  }
  if (mutant(Mutant::kSlabFarPadTooSmall)) {
    far = t.far * (1 - 0x1p-23F);
  }
  near = max_second(near, ray.tmin);
  far = min_second(far, tmax);
  return {near <= far, near};
}

bool is_regular(const Vec3& origin, const Vec3& direction, float tmin, float largest_coordinate) {
  bool some_direction = false;
  bool all_short = true;
  bool differences_fit = true;
  for (std::size_t a = 0; a < kAxes; ++a) {
    const float d = std::fabs(direction[a]);
    if (d != 0 && !(d >= 0x1p-126F && d <= 0x1p126F)) {
      return false;
    }
    some_direction = some_direction || d != 0;
    all_short = all_short && d <= 1;
    differences_fit = differences_fit && std::fabs(origin[a]) <= 0x1p126F;
  }
  differences_fit = differences_fit && largest_coordinate <= 0x1p127F;
  return some_direction && tmin >= 0 && (all_short || differences_fit);
}

}  // namespace

bool ray_is_active(const Vec3& origin, const Vec3& direction, float tmin, float tmax) {
  bool finite = std::isfinite(tmin) && tmin <= tmax;
  for (std::size_t a = 0; a < kAxes; ++a) {
    finite = finite && std::isfinite(origin[a]) && std::isfinite(direction[a]);
  }
  return finite;
}

SlabRay make_slab_ray(const Vec3& origin, const Vec3& direction, float tmin,
                      float largest_coordinate) {
  SlabRay ray;
  for (std::size_t a = 0; a < kAxes; ++a) {
    ray.origin[a] = origin[a];
    ray.dir[a] = direction[a];
    ray.rcp[a] = direction[a] == 0 ? kInfinity : 1.0F / direction[a];
    ray.negative |= static_cast<std::uint8_t>(direction[a] < 0 ? 1U << a : 0U);
  }
  ray.tmin = tmin;
  ray.regular = is_regular(origin, direction, tmin, largest_coordinate);
  return ray;
}

SlabHit slab_test(const SlabRay& ray, const Box& box, float tmax) {
  return ray.regular ? slab_test_regular(ray, box, tmax) : slab_test_wide(ray, box, tmax);
}

SlabHit slab_test_plain(const SlabRay& ray, const Box& box, float tmax) {
  const PlaneTimes t = unpadded_times(ray, box);
  const float near = max_second(t.near, ray.tmin);
  return {near <= min_second(t.far, tmax), near};
}

// FP64: |x - o| < 2^129 and |t| <= 2^129 / 2^-149 neither overflow nor underflow, so difference and
// quotient err by 2^-53 each; 2^-51 covers both and the padding's own rounding.
SlabHit slab_test_wide(const SlabRay& ray, const Box& box, float tmax) {
  constexpr double kWiden = 0x1p-51;
  double near = -std::numeric_limits<double>::infinity();
  double far = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < kAxes; ++a) {
    const double o = ray.origin[a];
    const double d = ray.dir[a];
    if (d == 0) {
      if (o < box.lo[a] || o > box.hi[a]) {
        return {};
      }
      continue;
    }
    const double first = ((d < 0 ? box.hi[a] : box.lo[a]) - o) / d;
    const double second = ((d < 0 ? box.lo[a] : box.hi[a]) - o) / d;
    near = std::max(near, first - std::fabs(first) * kWiden);
    far = std::min(far, second + std::fabs(second) * kWiden);
  }
  near = std::max(near, static_cast<double>(ray.tmin));
  far = std::min(far, static_cast<double>(tmax));
  return {near <= far, round_down(near)};
}

BoxBlock::BoxBlock() {
  for (std::size_t slot = 0; slot < kWidth; ++slot) {
    put(slot, Box{});
  }
}

void BoxBlock::put(std::size_t slot, const Box& box) {
  for (std::size_t a = 0; a < kAxes; ++a) {
    lo[a][slot] = box.lo[a];
    hi[a][slot] = box.hi[a];
  }
}

Box BoxBlock::get(std::size_t slot) const {
  Box box;
  for (std::size_t a = 0; a < kAxes; ++a) {
    box.lo[a] = lo[a][slot];
    box.hi[a] = hi[a][slot];
  }
  return box;
}

}  // namespace a2rt::arith
