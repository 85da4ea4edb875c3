// The driver's triangle test (workload/driver_triangle.h), bit for bit, arranged for speed: the
// axes are permuted by constant offsets and the verdict comes before the divisions.
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>

#include "a2rt/base/vec.h"
#include "a2rt/workload/workload.h"

namespace a2rt::rt {

class FastTriangle {
 public:
  FastTriangle(const Vec3& origin, const Vec3& dir) {
    const float o[3] = {origin.x, origin.y, origin.z}, d[3] = {dir.x, dir.y, dir.z};
    const float ax = std::fabs(d[0]), ay = std::fabs(d[1]), az = std::fabs(d[2]);
    kz_ = ax >= ay ? (ax >= az ? 0 : 2) : (ay >= az ? 1 : 2);
    kx_ = (kz_ + 1) % 3;
    ky_ = (kx_ + 1) % 3;
    if (d[kz_] < 0) {
      std::swap(kx_, ky_);
    }
    sz_ = 1.0F / d[kz_];
    sx_ = d[kx_] * sz_;
    sy_ = d[ky_] * sz_;
    ox_ = o[kx_], oy_ = o[ky_], oz_ = o[kz_];
  }

  // True if the line meets the triangle ahead; then t (may be NaN) and the facing are set.
  bool operator()(const Triangle& triangle, float& t, bool& front) const {
    // A triangle is nine consecutive floats, vertex by vertex.
    const float* f = &triangle.v[0].x;
    const float az = f[kz_] - oz_, bz = f[3 + kz_] - oz_, cz = f[6 + kz_] - oz_;
    const double ax = (f[kx_] - ox_) - sx_ * az, ay = (f[ky_] - oy_) - sy_ * az;
    const double bx = (f[3 + kx_] - ox_) - sx_ * bz, by = (f[3 + ky_] - oy_) - sy_ * bz;
    const double cx = (f[6 + kx_] - ox_) - sx_ * cz, cy = (f[6 + ky_] - oy_) - sy_ * cz;
    const double u = cx * by - cy * bx;
    const double v = ax * cy - ay * cx;
    const double w = bx * ay - by * ax;
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) {
      return false;
    }
    const double det = u + (v + w);
    const double sz = sz_;
    const double distance = (u * (sz * az) + v * (sz * bz)) + w * (sz * cz);
    const double sign = det > 0 ? 1 : det < 0 ? -1 : 0;
    if (sign * distance < 0) {
      return false;
    }
    t = static_cast<float>(distance / det);
    front = static_cast<float>(det) > 0;
    return true;
  }

 private:
  std::size_t kx_, ky_, kz_;
  float sx_, sy_, sz_;
  float ox_, oy_, oz_;
};

}  // namespace a2rt::rt
