// The arithmetic of stock lavapipe (Mesa 25.0) on triangles and instances, operation for operation.
//
// A unit whose triangle test is this one gets bit-equal distances to the driver's, so that every
// remaining difference is the unit's own. The test is the watertight one of Woop, Benthin and Wald,
// "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, with sheared vertices in FP32 and edge
// functions in FP64. All of it relies on separately rounded operations (-ffp-contract=off).
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>

#include "a2rt/base/vec.h"
#include "a2rt/workload/workload.h"

namespace a2rt {

// A point taken through an affine map; the translation is the first summand, as in the driver.
inline Vec3 driver_transform_point(const Affine& map, const Vec3& p) {
  Vec3 out;
  for (std::size_t i = 0; i < 3; ++i) {
    const float* m = map.m[i];
    out[i] = ((m[3] + p.x * m[0]) + p.y * m[1]) + p.z * m[2];
  }
  return out;
}

// A direction taken through the linear part of an affine map.
inline Vec3 driver_transform_direction(const Affine& map, const Vec3& d) {
  Vec3 out;
  for (std::size_t i = 0; i < 3; ++i) {
    const float* m = map.m[i];
    out[i] = (d.x * m[0] + d.y * m[1]) + d.z * m[2];
  }
  return out;
}

// What the test says of one triangle. Not compared with any interval or flag yet.
struct DriverTriangleHit {
  bool hit = false;
  float t = 0;  // along the object-space direction; may be NaN when the triangle is degenerate
  bool front = false;  // before an instance's flip: determinant > 0
  // Barycentric weights of vertices 1 and 2, in the driver's FP32.
  float u = 0, v = 0;
};

// The test for one object-space ray; set up once per ray and instance.
class DriverTriangleTest {
 public:
  DriverTriangleTest(const Vec3& origin, const Vec3& dir) : origin_(origin) {
    const float ax = std::fabs(dir.x), ay = std::fabs(dir.y), az = std::fabs(dir.z);
    kz_ = ax >= ay ? (ax >= az ? 0 : 2) : (ay >= az ? 1 : 2);
    kx_ = (kz_ + 1) % 3;
    ky_ = (kx_ + 1) % 3;
    if (dir[kz_] < 0) {
      std::swap(kx_, ky_);
    }
    sz_ = 1.0f / dir[kz_];
    sx_ = dir[kx_] * sz_;
    sy_ = dir[ky_] * sz_;
  }

  DriverTriangleHit operator()(const Triangle& triangle) const {
    const Sheared a = shear(triangle.v[0]), b = shear(triangle.v[1]), c = shear(triangle.v[2]);
    const double u = c.x * b.y - c.y * b.x;
    const double v = a.x * c.y - a.y * c.x;
    const double w = b.x * a.y - b.y * a.x;
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) {
      return {};
    }
    const double det = u + (v + w);
    const double t = (u * a.z + v * b.z) + w * c.z;
    const double sign = det > 0 ? 1 : det < 0 ? -1 : 0;
    if (sign * t < 0) {
      return {};
    }
    return {true, static_cast<float>(t / det), static_cast<float>(det) > 0,
            static_cast<float>(v / det), static_cast<float>(w / det)};
  }

 private:
  // Sheared x and y, and distance along the ray: FP32 values and one FP64 product.
  struct Sheared {
    double x, y, z;
  };
  Sheared shear(const Vec3& vertex) const {
    const float pz = vertex[kz_] - origin_[kz_];
    const float x = (vertex[kx_] - origin_[kx_]) - sx_ * pz;
    const float y = (vertex[ky_] - origin_[ky_]) - sy_ * pz;
    return {static_cast<double>(x), static_cast<double>(y),
            static_cast<double>(sz_) * static_cast<double>(pz)};
  }

  Vec3 origin_;
  std::size_t kx_, ky_, kz_;
  float sx_, sy_, sz_;
};

}  // namespace a2rt
