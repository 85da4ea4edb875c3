// Three-component vectors, boxes and affine maps in FP32, laid out as Vulkan lays them out.
#pragma once

#include <cstddef>
#include <limits>

namespace a2rt {

struct Vec3 {
  float x = 0, y = 0, z = 0;
  constexpr float operator[](std::size_t axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr float& operator[](std::size_t axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};
static_assert(sizeof(Vec3) == 12);

// Axis-aligned box; empty (lo = +inf, hi = -inf) by default.
struct Box {
  static constexpr float kInf = std::numeric_limits<float>::infinity();
  Vec3 lo{kInf, kInf, kInf};
  Vec3 hi{-kInf, -kInf, -kInf};
  constexpr void include(const Vec3& p) {
    for (std::size_t a = 0; a < 3; ++a) {
      lo[a] = p[a] < lo[a] ? p[a] : lo[a];
      hi[a] = p[a] > hi[a] ? p[a] : hi[a];
    }
  }
  constexpr void include(const Box& b) {
    for (std::size_t a = 0; a < 3; ++a) {
      lo[a] = b.lo[a] < lo[a] ? b.lo[a] : lo[a];
      hi[a] = b.hi[a] > hi[a] ? b.hi[a] : hi[a];
    }
  }
  constexpr bool valid() const { return lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z; }
  friend constexpr bool operator==(const Box&, const Box&) = default;
};
static_assert(sizeof(Box) == 24);

// Row-major 3x4 affine map, as VkTransformMatrixKHR.
struct Affine {
  float m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  friend constexpr bool operator==(const Affine&, const Affine&) = default;
};
static_assert(sizeof(Affine) == 48);

}  // namespace a2rt
