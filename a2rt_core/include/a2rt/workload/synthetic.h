// Workloads made from nothing: no Vulkan, no file. For tests and benches of the other rooms.
//
// The same Config gives the same workload on every run. All geometry lies within [-1, 1]^3 before
// instancing.
#pragma once

#include <cstdint>

#include "a2rt/workload/workload.h"

namespace a2rt::synthetic {

enum class Shape : std::uint8_t {
  kSoup,     // independent small triangles, random place, size and orientation
  kSphere,   // closed, indexed by latitude and longitude; slivers at the poles
  kTorus,    // closed, no poles
  kGrid,     // a flat square in z = 0: boxes without extent, coplanar neighbours
  kSlivers,  // long thin triangles, aspect ratio up to 1e6
  kSpheres   // procedural: AABBs, each with a sphere inside that an intersection shader would find
};

struct Config {
  Shape shape = Shape::kSoup;
  std::uint32_t primitives = 1000;  // asked for; closed shapes round up to what tessellates evenly
  std::uint32_t instances = 1;      // 1: identity; more: rotated, scaled, some mirrored or sheared
  double masked_share = 0;          // of the triangles, in a second, non-opaque geometry whose
                                    // any-hit shader ignores every other candidate
  std::uint32_t width = 32,
                height = 32;  // primary rays: a pinhole camera that sees the whole scene
  std::uint32_t secondary =
      2;  // rays per primary ray, from random surface points, in turn a
          // diffuse one and a shadow one (terminate on first hit, finite tmax)
  std::uint64_t seed = 1;
  bool reference = true;  // fill driver_hits by reference_hit(); costs rays * primitives. If not,
                          // every hit is kUnknown.
  bool driver_nodes = false;  // also build the trees in the driver's layout, for the exact walk
};

Workload make(const Config& config);

// Random numbers that are the same on every machine (SplitMix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  // Uniform in [0, 1) with 24 bits.
  float unit() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }
  float between(float lo, float hi) { return lo + (hi - lo) * unit(); }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(bits() % n); }
  Vec3 in_box(float lo, float hi) {
    const float x = between(lo, hi), y = between(lo, hi), z = between(lo, hi);
    return {x, y, z};
  }
  // Uniform on the unit sphere, by rejection.
  Vec3 direction();

 private:
  std::uint64_t state_;
};

}  // namespace a2rt::synthetic
