// Seeded rays, groups and child boxes, stratified by direction, distance, aspect and magnitude:
// what the guarantee and the property tests of arith/ run over.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "a2rt/base/vec.h"

namespace a2rt::hard {

// SplitMix64: small, fast, the same on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits();
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>((bits() >> 32) * n >> 32);
  }
  bool chance(std::uint32_t one_in) { return below(one_in) == 0; }
  float unit();  // [0, 1)
  float signed_unit() { return 2 * unit() - 1; }
  // sign * [1, 2) * 2^e with e uniform in [least, most].
  float magnitude(int least, int most, bool either_sign);
  // Any finite bit pattern.
  float any_finite();

 private:
  std::uint64_t state_;
};

enum class DirectionKind : std::uint8_t {
  kGeneric,
  kNearAxis,      // one or two components 2^-1 .. 2^-40 of the largest
  kAxis,          // one or two components +-0
  kDenormal,      // a component below 2^-126, others 1 or denormal too
  kUnnormalized,  // lengths 2^-60 .. 2^60
  kCount
};
enum class DistanceKind : std::uint8_t {
  kInside,
  kOnSurface,  // on a face, edge or corner of the group
  kNear,       // up to 4 extents
  kFar,        // up to 2^12 extents
  kExtreme,    // up to 2^25 extents
  kCount
};
enum class AspectKind : std::uint8_t { kCube, kMixed, kSliver, kFlat, kPoint, kCount };
enum class MagnitudeKind : std::uint8_t {
  kOrdinary,  // extents 2^-10 .. 2^10
  kOffset,    // extents small against the coordinates
  kGrid,      // planes on a binary grid, low corner a hair off it: ties and exact integers
  kTiny,      // extents down to denormal
  kHuge,      // extents up to FLT_MAX and beyond (hi - lo overflows)
  kCount
};
enum class AimKind : std::uint8_t { kRandom, kCorner, kEdge, kFace, kInterior, kCount };

struct Stratum {
  DirectionKind direction{};
  DistanceKind distance{};
  AspectKind aspect{};
  MagnitudeKind magnitude{};
};
inline constexpr std::uint32_t kStrata = 5 * 5 * 5 * 5;
Stratum stratum(std::uint32_t index);
std::string name_of(DirectionKind kind);
std::string name_of(DistanceKind kind);
std::string name_of(AspectKind kind);
std::string name_of(MagnitudeKind kind);
std::string name_of(const Stratum& s);

struct TestRay {
  Vec3 origin, direction;
  float tmin = 0, tmax = 0;
};

inline constexpr std::size_t kChildren = 8;
struct TestGroup {
  Box box;
  std::array<Box, kChildren> children;
};

TestGroup make_group(Random& random, const Stratum& s);
void make_children(Random& random, const Stratum& s, TestGroup& group);
// Always an active ray.
TestRay make_ray(Random& random, const Stratum& s, const TestGroup& group);

std::string describe(const TestRay& ray);
std::string describe(const Box& box);

}  // namespace a2rt::hard
