#include "a2rt/bvh/instance_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "a2rt/arith/slab.h"

namespace a2rt::bvh {
namespace {

using Row = std::array<double, 4>;
using Map = std::array<Row, 3>;

Map to_double(const Affine& a) {
  Map m{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      m[i][j] = static_cast<double>(a.m[i][j]);
    }
  }
  return m;
}

bool finite(const Map& m) {
  for (const Row& row : m) {
    for (const double v : row) {
      if (!std::isfinite(v)) {
        return false;
      }
    }
  }
  return true;
}

double cofactor(const Map& m, std::size_t i, std::size_t j) {
  const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3;
  const std::size_t j1 = (j + 1) % 3, j2 = (j + 2) % 3;
  return m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
}

struct Inverse {
  Map map;       // inverse of the linear part in columns 0..2
  double error;  // relative error of its entries against |inverse| row and column norms
};

std::optional<Inverse> invert(const Map& m) {
  const double det =
      m[0][0] * cofactor(m, 0, 0) + m[0][1] * cofactor(m, 0, 1) + m[0][2] * cofactor(m, 0, 2);
  if (det == 0 || !std::isfinite(det)) {
    return std::nullopt;
  }
  Inverse inverse{};
  double norm = 0, inverse_norm = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      inverse.map[i][j] = cofactor(m, j, i) / det;
      norm = std::max(norm, std::fabs(m[i][j]));
      inverse_norm = std::max(inverse_norm, std::fabs(inverse.map[i][j]));
    }
  }
  if (!std::isfinite(inverse_norm)) {
    return std::nullopt;
  }
  // Cramer's rule in doubles: the error grows with the condition number, itself bounded by norms.
  inverse.error = 64 * 0x1p-53 * (1 + 9 * norm * inverse_norm);
  return inverse;
}

struct Interval {
  double center, radius;
};

// World interval of axis k of the object box grown by `grow` on every side.
Interval world_interval(const Inverse& inverse, const Map& m, const Box& object,
                        const std::array<double, 3>& grow, double inverse_norm, std::size_t k) {
  double center = 0, radius = 0, magnitude = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double lo = static_cast<double>(object.lo[i]) - m[i][3];
    const double hi = static_cast<double>(object.hi[i]) - m[i][3];
    const double c = 0.5 * (lo + hi), r = 0.5 * (hi - lo) + grow[i];
    center += inverse.map[k][i] * c;
    radius += std::fabs(inverse.map[k][i]) * r;
    magnitude += std::fabs(c) + r;
  }
  return {center, radius + inverse.error * inverse_norm * magnitude};
}

double largest_entry(const Map& m) {
  double largest = 0;
  for (const Row& row : m) {
    for (std::size_t j = 0; j < 3; ++j) {
      largest = std::max(largest, std::fabs(row[j]));
    }
  }
  return largest;
}

// Rounding error |e| of the object point when |p| <= reach_p per axis.
std::array<double, 3> transform_error(const Map& m, const RayReach& reach,
                                      const std::array<double, 3>& reach_p) {
  constexpr double kUnit = 8 * 0x1p-24;
  double longest = 0;
  for (std::size_t j = 0; j < 3; ++j) {
    longest = std::max(longest, static_cast<double>(reach.origin[j]) + reach_p[j]);
  }
  // Underflow: up to eight products and sums lose 2^-149 each, scaled by t <= longest / |d|.
  const double underflow =
      8 * 0x1p-149 * (1 + longest / static_cast<double>(reach.shortest_direction));
  std::array<double, 3> error{};
  for (std::size_t i = 0; i < 3; ++i) {
    double sum = std::fabs(m[i][3]);
    for (std::size_t j = 0; j < 3; ++j) {
      sum += std::fabs(m[i][j]) * (2 * static_cast<double>(reach.origin[j]) + reach_p[j]);
    }
    error[i] = kUnit * sum + underflow;
  }
  return error;
}

float round_down(double v) {
  const auto f = static_cast<float>(v);
  return std::nextafterf(f, -INFINITY);
}
float round_up(double v) {
  const auto f = static_cast<float>(v);
  return std::nextafterf(f, INFINITY);
}

// Bounds of a world box stay finite in FP32.
constexpr double kLimit = 0x1p127;

}  // namespace

RayReach ray_reach(std::span<const Ray> rays, std::uint32_t tlas) {
  RayReach reach;
  for (const Ray& ray : rays) {
    // A ray that is not traced, or that no instance lets in, asks for no room.
    if (ray.tlas != tlas || (ray.mask & 0xff) == 0 ||
        !arith::ray_is_active(ray.origin, ray.dir, ray.tmin, ray.tmax)) {
      continue;
    }
    float longest = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (std::isfinite(ray.origin[a])) {
        reach.origin[a] = std::max(reach.origin[a], std::fabs(ray.origin[a]));
      }
      longest = std::max(longest, std::fabs(ray.dir[a]));
    }
    if (longest > 0) {
      reach.shortest_direction = std::min(reach.shortest_direction, longest);
    }
  }
  return reach;
}

Box unbounded_box(const RayReach& reach, const Box& object_box) {
  float largest = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    largest = std::max(
        {largest, reach.origin[a], std::fabs(object_box.lo[a]), std::fabs(object_box.hi[a])});
  }
  const float far =
      largest < kUnboundedReach / 2 ? kUnboundedReach : std::numeric_limits<float>::max();
  return {{-far, -far, -far}, {far, far, far}};
}

Box instance_world_box(const Instance& instance, const Box& object_box, const RayReach& reach) {
  if (instance.blas == kNone || !object_box.valid()) {
    return {};
  }
  const Map m = to_double(instance.world_to_object);
  if (!finite(m)) {
    return {};
  }
  if (instance.world_to_object == Affine{}) {
    return object_box;  // the driver's ray is the world's, bit for bit
  }
  const std::optional<Inverse> inverse = invert(m);
  if (!inverse) {
    return unbounded_box(reach, object_box);
  }
  const double inverse_norm = largest_entry(inverse->map);
  std::array<double, 3> reach_p{};
  // The bound on |e| needs a bound on |p|, which needs |e|: iterate until it closes.
  for (int round = 0; round < 8; ++round) {
    const std::array<double, 3> grow = transform_error(m, reach, reach_p);
    Box box;
    bool closed = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const Interval w = world_interval(*inverse, m, object_box, grow, inverse_norm, k);
      const double most = std::fabs(w.center) + w.radius;
      if (!(most < kLimit)) {
        return unbounded_box(reach, object_box);
      }
      closed = closed && most <= reach_p[k];
      reach_p[k] = std::max(reach_p[k], 1.0000001 * most + 0x1p-140);
      box.lo[k] = round_down(w.center - w.radius);
      box.hi[k] = round_up(w.center + w.radius);
    }
    if (closed) {
      return box;
    }
  }
  return unbounded_box(reach, object_box);
}

}  // namespace a2rt::bvh
