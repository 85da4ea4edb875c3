#include "a2rt/arith/oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "a2rt/arith/directed.h"

namespace a2rt::arith {
namespace {

constexpr std::size_t kAxes = 3;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A time distance / speed with speed > 0, both exact FP64 numbers.
struct ExactTime {
  double distance, speed;
};

// a <= b, exactly: cross products of FP64 distances with FP32 speeds as unevaluated FP64 pairs.
// Products lie within 2^-298 .. 2^258, so neither they nor their fma residuals over- or underflow.
// RN is monotone: different heads order the exact values, equal heads leave it to the tails.
bool not_later(const ExactTime& a, const ExactTime& b) {
  const double left = a.distance * b.speed;
  const double right = b.distance * a.speed;
  if (left != right) {
    return left < right;
  }
  return std::fma(a.distance, b.speed, -left) <= std::fma(b.distance, a.speed, -right);
}

struct PairAnswer {
  bool known = false, hit = false;
};

PairAnswer decide_by_pairs(const OracleRay& ray, const Box& box, float tmax) {
  ExactTime near[kAxes + 1];
  ExactTime far[kAxes + 1];
  std::size_t nears = 0;
  std::size_t fars = 0;
  near[nears++] = {ray.tmin, 1};
  if (tmax < kInfinity) {
    far[fars++] = {tmax, 1};
  }
  for (std::size_t a = 0; a < kAxes; ++a) {
    if (ray.dir[a] == 0) {
      continue;
    }
    const double sign = ray.dir[a] < 0 ? -1 : 1;
    const ExactSum lo = two_sum(box.lo[a], -ray.origin[a]);
    const ExactSum hi = two_sum(box.hi[a], -ray.origin[a]);
    if (lo.error != 0 || hi.error != 0) {
      return {};
    }
    const double speed = std::fabs(ray.dir[a]);
    near[nears++] = {sign * (sign > 0 ? lo.sum : hi.sum), speed};
    far[fars++] = {sign * (sign > 0 ? hi.sum : lo.sum), speed};
  }
  for (std::size_t i = 0; i < nears; ++i) {
    for (std::size_t j = 0; j < fars; ++j) {
      if (!not_later(near[i], far[j])) {
        return {true, false};
      }
    }
  }
  return {true, true};
}

}  // namespace

OracleRay::OracleRay(const Vec3& o, const Vec3& d, float least) : tmin(least) {
  for (std::size_t a = 0; a < kAxes; ++a) {
    origin[a] = o[a];
    dir[a] = d[a];
    rcp[a] = d[a] == 0 ? 0.0 : 1.0 / static_cast<double>(d[a]);
  }
}

bool ray_meets_box(const OracleRay& ray, const Box& box, float tmax, OracleStage& decided_by) {
  decided_by = OracleStage::kInterval;
  // Difference, reciprocal and product err by 2^-53 each.
  constexpr double kWiden = 0x1p-51;
  double near_low = ray.tmin, near_high = ray.tmin;
  double far_low = tmax, far_high = tmax;
  for (std::size_t a = 0; a < kAxes; ++a) {
    if (ray.dir[a] == 0) {
      if (ray.origin[a] < box.lo[a] || ray.origin[a] > box.hi[a]) {
        return false;
      }
      continue;
    }
    const bool negative = ray.dir[a] < 0;
    const double near = ((negative ? box.hi[a] : box.lo[a]) - ray.origin[a]) * ray.rcp[a];
    const double far = ((negative ? box.lo[a] : box.hi[a]) - ray.origin[a]) * ray.rcp[a];
    const double near_slack = std::fabs(near) * kWiden;
    const double far_slack = std::fabs(far) * kWiden;
    near_low = std::max(near_low, near - near_slack);
    near_high = std::max(near_high, near + near_slack);
    far_low = std::min(far_low, far - far_slack);
    far_high = std::min(far_high, far + far_slack);
  }
  if (near_high <= far_low) {
    return true;
  }
  if (near_low > far_high) {
    return false;
  }
  decided_by = OracleStage::kPairs;
  const PairAnswer answer = decide_by_pairs(ray, box, tmax);
  if (answer.known) {
    return answer.hit;
  }
  decided_by = OracleStage::kRational;
  return ray_meets_box_rational(ray, box, tmax);
}

bool ray_meets_box(const OracleRay& ray, const Box& box, float tmax) {
  OracleStage ignored{};
  return ray_meets_box(ray, box, tmax, ignored);
}

}  // namespace a2rt::arith
