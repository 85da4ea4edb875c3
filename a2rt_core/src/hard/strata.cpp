#include "a2rt/hard/strata.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>

namespace a2rt::hard {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();

float finite(double x) {
  return static_cast<float>(
      std::clamp(x, -static_cast<double>(kLargest), static_cast<double>(kLargest)));
}

double extent_of(const Box& box, std::size_t a) {
  return static_cast<double>(box.hi[a]) - static_cast<double>(box.lo[a]);
}

double largest_extent(const Box& box) {
  return std::max({extent_of(box, 0), extent_of(box, 1), extent_of(box, 2)});
}

// A plane inside [lo, hi], often on a face, sometimes on a fine grid of the extent.
float plane_within(Random& random, float lo, float hi, MagnitudeKind kind) {
  if (random.chance(6)) {
    return random.chance(2) ? lo : hi;
  }
  const double extent = static_cast<double>(hi) - lo;
  double part = random.unit();
  if (kind == MagnitudeKind::kGrid || random.chance(8)) {
    part = random.below(256) / 255.0;
  }
  float x = finite(lo + part * extent);
  if (kind == MagnitudeKind::kGrid) {
    x = std::round(x);
  }
  return std::clamp(x, lo, hi);
}

int extent_exponent(Random& random, MagnitudeKind kind) {
  switch (kind) {
    case MagnitudeKind::kTiny:
      return -150 + static_cast<int>(random.below(60));
    case MagnitudeKind::kHuge:
      return 100 + static_cast<int>(random.below(30));
    default:
      return -10 + static_cast<int>(random.below(21));
  }
}

double aspect_factor(Random& random, AspectKind kind, std::size_t axis, std::size_t special) {
  switch (kind) {
    case AspectKind::kCube:
      return 1;
    case AspectKind::kMixed:
      return std::ldexp(1.0 + random.unit(), -static_cast<int>(random.below(6)));
    case AspectKind::kSliver:
      return axis == special
                 ? 1
                 : std::ldexp(1.0 + random.unit(), -10 - static_cast<int>(random.below(14)));
    case AspectKind::kFlat:
      return axis == special ? 0 : 1.0 + random.unit();
    default:
      return 0;
  }
}

Vec3 generic_direction(Random& random) {
  Vec3 d;
  double length = 0;
  do {
    for (std::size_t a = 0; a < 3; ++a) {
      d[a] = random.signed_unit();
    }
    length = std::sqrt(static_cast<double>(d.x) * d.x + static_cast<double>(d.y) * d.y +
                       static_cast<double>(d.z) * d.z);
  } while (length > 1 || length < 0.01);
  for (std::size_t a = 0; a < 3; ++a) {
    d[a] = static_cast<float>(d[a] / length);
  }
  return d;
}

Vec3 direction_of(Random& random, DirectionKind kind) {
  Vec3 d = generic_direction(random);
  const std::size_t main = random.below(3);
  for (std::size_t a = 0; a < 3; ++a) {
    if (a == main) {
      d[a] = kind == DirectionKind::kGeneric ? d[a] : d[a] < 0 ? -1.0F : 1.0F;
      continue;
    }
    const bool change = random.below(3) != 0;
    if (kind == DirectionKind::kNearAxis && change) {
      d[a] = random.magnitude(-40, -1, true);
    } else if (kind == DirectionKind::kAxis && change) {
      d[a] = random.chance(2) ? 0.0F : -0.0F;
    } else if (kind == DirectionKind::kDenormal && change) {
      d[a] = random.magnitude(-149, -120, true);
    }
  }
  if (kind == DirectionKind::kDenormal && random.chance(4)) {
    d[main] = random.magnitude(-149, -120, true);
  }
  if (kind == DirectionKind::kUnnormalized) {
    const float scale = random.magnitude(-60, 60, false);
    for (std::size_t a = 0; a < 3; ++a) {
      d[a] *= scale;
    }
  }
  return d;
}

// A point of the box to aim at.
Vec3 target_in(Random& random, const Box& box, AimKind aim) {
  Vec3 p;
  std::array<bool, 3> pinned{};
  const std::size_t free_axis = random.below(3);
  for (std::size_t a = 0; a < 3; ++a) {
    pinned[a] = aim == AimKind::kCorner || (aim == AimKind::kEdge && a != free_axis) ||
                (aim == AimKind::kFace && a == free_axis);
    const double inside = box.lo[a] + random.unit() * extent_of(box, a);
    p[a] = pinned[a] ? (random.chance(2) ? box.lo[a] : box.hi[a])
                     : std::clamp(finite(inside), box.lo[a], box.hi[a]);
  }
  return p;
}

Vec3 origin_of(Random& random, const Stratum& s, const Box& group) {
  if (s.distance == DistanceKind::kInside) {
    return target_in(random, group, AimKind::kInterior);
  }
  if (s.distance == DistanceKind::kOnSurface) {
    return target_in(random, group, static_cast<AimKind>(1 + random.below(3)));
  }
  int most = s.distance == DistanceKind::kNear ? 2 : s.distance == DistanceKind::kFar ? 12 : 25;
  double reach = largest_extent(group);
  reach = reach == 0 ? 1.0 : reach;
  Vec3 o = target_in(random, group, AimKind::kInterior);
  const double distance =
      reach * std::ldexp(0.5 + random.unit(),
                         static_cast<int>(random.below(static_cast<std::uint32_t>(most + 1))));
  const Vec3 away = generic_direction(random);
  for (std::size_t a = 0; a < 3; ++a) {
    o[a] = finite(o[a] + distance * away[a]);
  }
  return o;
}

// Moves the origin so that the ray (with its fixed direction) passes near `target`.
void aim_by_moving(Vec3& origin, const Vec3& direction, const Vec3& target) {
  double t = 0;
  double norm = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    norm += static_cast<double>(direction[a]) * direction[a];
    t += (static_cast<double>(target[a]) - origin[a]) * direction[a];
  }
  if (norm == 0) {
    return;
  }
  t = std::fabs(t / norm);
  for (std::size_t a = 0; a < 3; ++a) {
    origin[a] = finite(target[a] - t * direction[a]);
  }
}

// Points a generic direction from origin to target, keeping its length class.
void aim_by_turning(const Vec3& origin, Vec3& direction, const Vec3& target) {
  std::array<double, 3> delta{};
  double most = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    delta[a] = static_cast<double>(target[a]) - origin[a];
    most = std::max(most, std::fabs(delta[a]));
  }
  if (most == 0) {
    return;
  }
  double length = 0;
  for (double& x : delta) {
    x /= most;
    length += x * x;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    direction[a] = static_cast<float>(delta[a] / std::sqrt(length));
  }
}

void choose_interval(Random& random, const TestGroup& group, TestRay& ray) {
  ray.tmin = random.chance(4) ? 0.001F : 0.0F;
  ray.tmax = std::numeric_limits<float>::infinity();
  if (random.chance(2)) {
    return;
  }
  // An end near the group, so that the interval matters.
  double speed = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    speed = std::max(speed, std::fabs(static_cast<double>(ray.direction[a])));
  }
  double reach = largest_extent(group.box);
  for (std::size_t a = 0; a < 3; ++a) {
    reach = std::max(reach, std::fabs(static_cast<double>(group.box.lo[a]) - ray.origin[a]));
  }
  const float end = finite(speed == 0 ? 1 : reach / speed * (0.5 + random.unit()));
  switch (random.below(5)) {
    case 0:
      ray.tmin = end / 2;
      ray.tmax = end;
      break;
    case 1:
      ray.tmin = ray.tmax = end;
      break;
    case 2:
      ray.tmin = ray.tmax = 0;
      break;
    case 3:
      ray.tmin = 0;
      ray.tmax = random.chance(4) ? kLargest : end;
      break;
    default:
      ray.tmin = end;
      break;
  }
}

}  // namespace

std::uint64_t Random::bits() {
  state_ += 0x9E3779B97F4A7C15ULL;
  std::uint64_t z = state_;
  z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ z >> 27) * 0x94D049BB133111EBULL;
  return z ^ z >> 31;
}

float Random::unit() { return static_cast<float>(bits() >> 40) * 0x1p-24F; }

float Random::magnitude(int least, int most, bool either_sign) {
  const int e = least + static_cast<int>(below(static_cast<std::uint32_t>(most - least + 1)));
  const auto x = static_cast<float>(std::ldexp(1.0 + unit(), e));
  return either_sign && chance(2) ? -x : x;
}

float Random::any_finite() {
  for (;;) {
    const auto x = std::bit_cast<float>(static_cast<std::uint32_t>(bits() >> 32));
    if (std::isfinite(x)) {
      return x;
    }
  }
}

Stratum stratum(std::uint32_t index) {
  Stratum s;
  s.direction = static_cast<DirectionKind>(index % 5);
  s.distance = static_cast<DistanceKind>(index / 5 % 5);
  s.aspect = static_cast<AspectKind>(index / 25 % 5);
  s.magnitude = static_cast<MagnitudeKind>(index / 125 % 5);
  return s;
}

std::string name_of(DirectionKind kind) {
  static constexpr const char* kNames[] = {"generic", "near axis", "axis", "denormal",
                                           "unnormalized"};
  return kNames[static_cast<std::size_t>(kind)];
}
std::string name_of(DistanceKind kind) {
  static constexpr const char* kNames[] = {"inside", "on surface", "near", "far", "extreme"};
  return kNames[static_cast<std::size_t>(kind)];
}
std::string name_of(AspectKind kind) {
  static constexpr const char* kNames[] = {"cube", "mixed", "sliver", "flat", "point"};
  return kNames[static_cast<std::size_t>(kind)];
}
std::string name_of(MagnitudeKind kind) {
  static constexpr const char* kNames[] = {"ordinary", "offset", "grid", "tiny", "huge"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string name_of(const Stratum& s) {
  return name_of(s.direction) + " direction, " + name_of(s.distance) + ", " + name_of(s.aspect) +
         ", " + name_of(s.magnitude);
}

void make_children(Random& random, const Stratum& s, TestGroup& group) {
  for (Box& child : group.children) {
    for (std::size_t a = 0; a < 3; ++a) {
      float p = plane_within(random, group.box.lo[a], group.box.hi[a], s.magnitude);
      float q = random.chance(8)
                    ? p
                    : plane_within(random, group.box.lo[a], group.box.hi[a], s.magnitude);
      if (p > q) {
        std::swap(p, q);
      }
      child.lo[a] = p;
      child.hi[a] = q;
    }
  }
}

TestGroup make_group(Random& random, const Stratum& s) {
  TestGroup group;
  const int exponent = extent_exponent(random, s.magnitude);
  const double size = std::ldexp(1.0 + random.unit(), exponent);
  const std::size_t special = random.below(3);
  for (std::size_t a = 0; a < 3; ++a) {
    const double extent = size * aspect_factor(random, s.aspect, a, special);
    double low = random.signed_unit() * size * 4;
    if (s.magnitude == MagnitudeKind::kOffset) {
      low = random.magnitude(0, 14, true) * size;
    } else if (s.magnitude == MagnitudeKind::kHuge) {
      low = -extent * random.unit();
    }
    group.box.lo[a] = finite(low);
    group.box.hi[a] = std::max(group.box.lo[a], finite(low + extent));
    if (s.magnitude == MagnitudeKind::kGrid) {
      const float hair = random.magnitude(-100, -30, true);
      const float steps = random.chance(2) ? 255.0F : 253.0F;
      group.box.lo[a] = random.chance(3) ? 0.0F : hair;
      group.box.hi[a] = extent == 0 ? group.box.lo[a] : steps;
    }
  }
  make_children(random, s, group);
  return group;
}

TestRay make_ray(Random& random, const Stratum& s, const TestGroup& group) {
  TestRay ray;
  ray.direction = direction_of(random, s.direction);
  ray.origin = origin_of(random, s, group.box);
  const auto aim = static_cast<AimKind>(random.below(5));
  if (aim != AimKind::kRandom) {
    const Vec3 target = target_in(random, group.children[random.below(kChildren)], aim);
    if (s.distance == DistanceKind::kInside || s.distance == DistanceKind::kOnSurface ||
        (s.direction == DirectionKind::kGeneric && random.chance(2))) {
      if (s.direction == DirectionKind::kGeneric) {
        aim_by_turning(ray.origin, ray.direction, target);
      }
    } else {
      aim_by_moving(ray.origin, ray.direction, target);
    }
  }
  choose_interval(random, group, ray);
  return ray;
}

std::string describe(const TestRay& ray) {
  char text[400];
  std::snprintf(text, sizeof text, "ray o = {%a, %a, %a} d = {%a, %a, %a} t = [%a, %a]",
                static_cast<double>(ray.origin.x), static_cast<double>(ray.origin.y),
                static_cast<double>(ray.origin.z), static_cast<double>(ray.direction.x),
                static_cast<double>(ray.direction.y), static_cast<double>(ray.direction.z),
                static_cast<double>(ray.tmin), static_cast<double>(ray.tmax));
  return text;
}

std::string describe(const Box& box) {
  char text[300];
  std::snprintf(text, sizeof text, "box {%a, %a, %a} .. {%a, %a, %a}",
                static_cast<double>(box.lo.x), static_cast<double>(box.lo.y),
                static_cast<double>(box.lo.z), static_cast<double>(box.hi.x),
                static_cast<double>(box.hi.y), static_cast<double>(box.hi.z));
  return text;
}

}  // namespace a2rt::hard
