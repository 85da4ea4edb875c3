// Directions: generic, parallel to an axis, almost so, denormal, zero, not of length one.
#include <cmath>

#include "case_builder.h"
#include "cases.h"

namespace a2rt::hard {
namespace {

constexpr std::uint32_t kTriangles = 600;

// Rays through points of a soup whose direction is +-1 on one axis and `small()` on one or both of
// the others; what is left is a tenth or so, so that only the named component is special.
template <class Small>
Workload along_axes(std::uint64_t seed, const Small& small) {
  CaseBuilder c(seed);
  c.blas(soup(kTriangles, 0.25F, 1, seed));
  synthetic::Random& random = c.random();
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    const Vec3 target = c.surface_point();
    const std::size_t main = i % 3, special = (main + 1 + i / 3 % 2) % 3;
    const std::size_t other = 3 - main - special;
    Vec3 d;
    d[main] = i / 6 % 2 == 0 ? 1.0F : -1.0F;
    d[special] = small(random);
    d[other] = i / 12 % 2 == 0 ? small(random) : random.between(-0.2F, 0.2F);
    c.ray(target - 3 * d, d);
  }
  return c.finish();
}

float power(synthetic::Random& random, int least, int most) {
  const int exponent = least + static_cast<int>(random.below(static_cast<unsigned>(most - least)));
  const float x = std::ldexp(1 + random.unit(), exponent);
  return random.below(2) == 0 ? x : -x;
}

Workload generic() {
  CaseBuilder c(11);
  c.blas(soup(kTriangles, 0.25F, 1, 11));
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    const Vec3 origin = 3 * c.random().direction();
    c.ray(origin, c.random().in_box(-1, 1) - origin);
  }
  return c.finish();
}

Workload axis_parallel() {
  return along_axes(12, [](synthetic::Random& r) { return r.below(2) == 0 ? 0.0F : -0.0F; });
}
// The powers stop where AQB8's 5-bit shift (from 2^-16 on) and its exponent (from 2^-32 on) end.
Workload near_axis_above() {
  return along_axes(13, [](synthetic::Random& r) { return power(r, -15, -4); });
}
Workload near_axis_below() {
  return along_axes(14, [](synthetic::Random& r) { return power(r, -31, -17); });
}
Workload tiny() {
  return along_axes(15, [](synthetic::Random& r) { return power(r, -126, -33); });
}
Workload denormal() {
  return along_axes(16, [](synthetic::Random& r) { return power(r, -149, -127); });
}

Workload zero() {
  CaseBuilder c(17);
  c.blas(soup(kTriangles, 0.25F, 1, 17));
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    const Vec3 d{i % 2 == 0 ? 0.0F : -0.0F, i % 3 == 0 ? 0.0F : -0.0F, 0};
    c.ray(c.surface_point(), d, 0, i % 5 == 0 ? 1.0F : kInfinity);
  }
  return c.finish();
}

Workload lengths() {
  CaseBuilder c(18);
  c.blas(soup(kTriangles, 0.25F, 1, 18));
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    const Vec3 target = c.surface_point(), origin = 3 * c.random().direction();
    const auto exponent = static_cast<int>(c.random().below(121)) - 60;
    c.ray(origin, std::ldexp(1.0F, exponent) * (target - origin));
  }
  return c.finish();
}

}  // namespace

std::vector<HardCase> direction_cases() {
  const std::string group = "Directions";
  return {
      {"generic", group, "Generic rays (control)",
       "600 triangles in random places, rays from a sphere around them.", generic},
      {"axis_parallel", group, "Parallel to an axis: ±0",
       "One or two components of the direction are +0 or −0; the rays pass through the triangles.",
       axis_parallel},
      {"near_axis", group, "Near an axis: 2⁻⁴ to 2⁻¹⁵",
       "One or two components between 2^-4 and 2^-15 of the largest.", near_axis_above},
      {"nearer_axis", group, "Nearer: 2⁻¹⁷ to 2⁻³¹",
       "One or two components between 2^-17 and 2^-31 of the largest.", near_axis_below},
      {"tiny_direction", group, "Nearest: 2⁻³³ to 2⁻¹²⁶",
       "One or two components between 2^-33 and the smallest normal number.", tiny},
      {"denormal_direction", group, "Denormal components",
       "One or two components are denormal numbers.", denormal},
      {"zero_direction", group, "Zero direction",
       "All components are zero: the ray is its origin, which lies on a triangle.", zero},
      {"unnormalized", group, "Lengths 2⁻⁶⁰ to 2⁶⁰", "Directions that are not of length one.",
       lengths}};
}

}  // namespace a2rt::hard
