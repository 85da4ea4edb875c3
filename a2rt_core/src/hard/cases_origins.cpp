// Origins and intervals: inside a box, on its face, edge or corner, far away; ends of the ray.
#include <cmath>

#include "case_builder.h"
#include "cases.h"

namespace a2rt::hard {
namespace {

// 64 separate axis-aligned boxes: their faces are the faces of nodes.
std::vector<Triangle> scattered_boxes(std::vector<Box>& boxes) {
  synthetic::Random random(31);
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < 64; ++i) {
    const Vec3 lo = random.in_box(-1, 0.7F);
    boxes.push_back({lo, lo + random.in_box(0.05F, 0.3F)});
    add_box(triangles, boxes.back());
  }
  return triangles;
}

// Rays that start on a box, with `pinned` of its coordinates on a plane of the box: 0 inside, 1 on
// a face, 2 on an edge, 3 on a corner.
Workload starting_on(std::uint32_t pinned) {
  CaseBuilder c(32 + pinned);
  std::vector<Box> boxes;
  c.blas(scattered_boxes(boxes));
  synthetic::Random& random = c.random();
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    const Box& box = boxes[random.below(static_cast<std::uint32_t>(boxes.size()))];
    Vec3 origin;
    for (std::size_t a = 0; a < 3; ++a) {
      origin[a] = random.between(box.lo[a], box.hi[a]);
    }
    for (std::uint32_t p = 0, a = random.below(3); p < pinned; ++p, ++a) {
      origin[a % 3] = random.below(2) == 0 ? box.lo[a % 3] : box.hi[a % 3];
    }
    Vec3 d = random.direction();
    if (i % 3 == 0) {
      d = {};
      d[i / 3 % 3] = i % 2 == 0 ? 1.0F : -1.0F;
    }
    c.ray(origin, d, i % 4 == 0 ? 1e-3F : 0.0F);
  }
  return c.finish();
}
Workload inside() { return starting_on(0); }
Workload on_face() { return starting_on(1); }
Workload on_edge() { return starting_on(2); }
Workload on_corner() { return starting_on(3); }

Workload far_away() {
  CaseBuilder c(37);
  c.blas(soup(600, 0.25F, 1, 37));
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    const Vec3 target = c.surface_point();
    const Vec3 d = c.random().direction();
    // Aimed from where the ray really starts, so that it hits although its origin is rounded.
    const Vec3 origin = target - 2e7F * d;
    c.ray(origin, i % 2 == 0 ? target - origin : d);
  }
  return c.finish();
}

// Small geometry far from the origin of coordinates: differences cancel.
Workload offset() {
  CaseBuilder c(38);
  std::vector<Triangle> triangles = soup(600, 0.25F, 1, 38);
  for (Triangle& t : triangles) {
    for (Vec3& v : t.v) {
      v = Vec3{1e5F, -2e5F, 3e5F} + v;
    }
  }
  c.blas(std::move(triangles));
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    const Vec3 target = c.surface_point(), origin = target - 30 * c.random().direction();
    c.ray(origin, i % 2 == 0 ? target - origin : target);
  }
  return c.finish();
}

enum class End { kTmax, kTmin, kBoth, kInverted };

// Axis-parallel rays whose interval begins or ends exactly at a plane of a box; powers of two keep
// the distances exact.
Workload interval(std::uint64_t seed, const std::vector<End>& ends) {
  CaseBuilder c(seed);
  c.blas(stacked_cubes(4));
  synthetic::Random& random = c.random();
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    const std::size_t axis = i % 3;
    Vec3 d{random.between(-0.25F, 0.25F), random.between(-0.25F, 0.25F),
           random.between(-0.25F, 0.25F)};
    if (i % 2 == 0) {
      d = {};
    }
    d[axis] = i % 4 < 2 ? 1.0F : 0.5F;
    Vec3 origin = 2 * (random.in_box(-1, 1) + Vec3{1, 1, 1});
    origin[axis] = -2;
    const float plane = (2 + static_cast<float>(random.below(5))) / d[axis];
    const float hair = std::nextafter(plane, i % 8 < 4 ? 0.0F : kInfinity);
    const float at = i % 3 == 0 ? plane : hair;
    switch (ends[random.below(static_cast<std::uint32_t>(ends.size()))]) {
      case End::kTmax:
        c.ray(origin, d, 0, at);
        break;
      case End::kTmin:
        c.ray(origin, d, at);
        break;
      case End::kBoth:
        c.ray(origin, d, at, at);
        break;
      case End::kInverted:
        c.ray(origin, d, at, at / 2);
        break;
    }
  }
  return c.finish();
}
Workload interval_end() { return interval(39, {End::kTmax}); }
Workload interval_begin() { return interval(40, {End::kTmin}); }
Workload interval_empty() { return interval(41, {End::kBoth, End::kInverted}); }

}  // namespace

std::vector<HardCase> origin_cases() {
  const std::string group = "Origins";
  return {
      {"origin_inside", group, "Origin inside a box", "Rays that start inside one of 64 boxes.",
       inside},
      {"origin_on_face", group, "Origin on a face", "Rays that start exactly on a face.", on_face},
      {"origin_on_edge", group, "Origin on an edge", "Rays that start exactly on an edge.",
       on_edge},
      {"origin_on_corner", group, "Origin at a corner", "Rays that start exactly at a corner.",
       on_corner},
      {"origin_far", group, "Origin 10⁷ extents away",
       "600 triangles, rays that start ten million times their extent away.", far_away},
      {"offset", group, "Far from the origin of coordinates",
       "The same triangles moved by about 4·10^5 extents, rays from near by.", offset}};
}

std::vector<HardCase> interval_cases() {
  const std::string group = "Intervals";
  return {
      {"tmax", group, "tmax at a face, or one step beside it",
       "64 cubes that share faces; the ray ends exactly at a face or one FP32 step off.",
       interval_end},
      {"tmin", group, "tmin at a face, or one step beside it",
       "The ray begins exactly at a face or one step off; tmax is infinite.", interval_begin},
      {"tmin_tmax", group, "tmin = tmax, and tmin > tmax",
       "Intervals of one point at a face, and inverted ones, which hit nothing.", interval_empty}};
}

}  // namespace a2rt::hard
