#include "a2rt/hard/views.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "a2rt/workload/driver_triangle.h"
#include "case_builder.h"

namespace a2rt::hard {
namespace {

std::vector<Triangle> ball() {
  synthetic::Config config;
  config.shape = synthetic::Shape::kSphere;
  config.primitives = 3000;
  config.width = config.height = 1;
  config.secondary = 0;
  config.reference = false;
  return synthetic::make(config).blas[0].triangles;
}

// Position of a pixel's centre in [-1.1, 1.1], odd sides have one exactly at 0.
float place(std::uint32_t i, std::uint32_t side) {
  return 1.1F * (2 * (static_cast<float>(i) + 0.5F) / static_cast<float>(side) - 1);
}

// Parallel rays in direction `d` (d.z = -1) through a grid in the plane z = 0, from `back` away.
Workload parallel(std::uint32_t side, const Vec3& d, float back) {
  CaseBuilder c(71);
  c.blas(ball());
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const Vec3 target{place(x, side), -place(y, side), 0};
      c.ray(target - back * d, d);
    }
  }
  return c.finish();
}

// A camera on the z axis that looks along it: its middle column and row have a zero component.
Workload pinhole(std::uint32_t side) {
  CaseBuilder c(72);
  c.blas(ball());
  const std::uint32_t odd = side | 1U;
  const Vec3 eye{0, 0, 3};
  for (std::uint32_t y = 0; y < odd; ++y) {
    for (std::uint32_t x = 0; x < odd; ++x) {
      const bool middle_x = x == odd / 2, middle_y = y == odd / 2;
      const Vec3 target{middle_x ? 0 : place(x, odd), middle_y ? 0 : -place(y, odd), 0};
      c.ray(eye, target - eye);
    }
  }
  return c.finish();
}

Workload shifted(std::uint32_t side) { return parallel(side, {0x1.5p-17F, 0x1.9p-18F, -1}, 3); }
Workload wrapped(std::uint32_t side) { return parallel(side, {0x1.4p-40F, 0x1.8p-36F, -1}, 3); }

// Rays from far away: a unit in the last place of the origin is wide against the triangles.
Workload from_afar(std::uint32_t side, std::vector<Triangle> body) {
  CaseBuilder c(73);
  c.blas(std::move(body));
  const Vec3 d{0.3F, -0.2F, -1};
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const Vec3 target{place(x, side), -place(y, side), 0};
      const Vec3 origin = target - 0x1p21F * d;
      c.ray(origin, target - origin);
    }
  }
  return c.finish();
}
Workload far_away(std::uint32_t side) { return from_afar(side, ball()); }
Workload shells_far_away(std::uint32_t side) {
  std::vector<Triangle> body = ball(), inner = ball();
  for (Triangle& t : inner) {
    for (Vec3& v : t.v) {
      v = 0.999F * v;
    }
  }
  body.insert(body.end(), inner.begin(), inner.end());
  return from_afar(side, std::move(body));
}

// A cube whose faces are kTiles x kTiles tiles. Thirteenths are no FP32 numbers, so that rays
// through the tiles' edges meet the planes of boxes at times that differ by rounding only.
constexpr int kTiles = 13;
float line(int i) {
  return i == kTiles ? 1 : -1 + 2.0F * static_cast<float>(i) / static_cast<float>(kTiles);
}

// Pixels exactly on every vertex of the wall z = -1, on points of its edges, and between them; also
// one tile beyond it.
Workload tiled_wall(std::uint32_t side, const Vec3& eye) {
  CaseBuilder c(74);
  c.blas(subdivided_cube({{-1, -1, -1}, {1, 1, 1}}, kTiles));
  const int pixels = std::max(1, static_cast<int>(side) / (kTiles + 2));
  const int last = (kTiles + 2) * pixels;
  const auto at = [&](int i) {
    const int tile = i / pixels - 1;
    const float share = static_cast<float>(i % pixels) / static_cast<float>(pixels);
    return share == 0 ? line(tile) : (1 - share) * line(tile) + share * line(tile + 1);
  };
  for (int y = 0; y <= last; ++y) {
    for (int x = 0; x <= last; ++x) {
      c.ray(eye, Vec3{at(x), at(last - y), -1} - eye);
    }
  }
  return c.finish();
}
// From a point straight before a vertex; from the cube's diagonal.
Workload from_inside(std::uint32_t side) { return tiled_wall(side, {line(5), line(8), line(10)}); }
Workload from_the_diagonal(std::uint32_t side) { return tiled_wall(side, {3, 3, 3}); }

// Light from the camera: the cosine between the ray and the triangle's plane.
std::uint8_t brightness(const Workload& w, const Ray& ray, const Hit& hit) {
  const Blas& blas = w.blas[w.tlas[0].instances[hit.instance].blas];
  const Triangle& t = blas.triangles[blas.geometries[hit.geometry].first + hit.primitive];
  const Vec3 a = t.v[1] - t.v[0], b = t.v[2] - t.v[0];
  const Vec3 n{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  const auto dot = [](const Vec3& p, const Vec3& q) {
    return static_cast<double>(p.x) * q.x + static_cast<double>(p.y) * q.y +
           static_cast<double>(p.z) * q.z;
  };
  const double length = std::sqrt(dot(n, n) * dot(ray.dir, ray.dir));
  const double cosine = length > 0 ? std::fabs(dot(n, ray.dir)) / length : 0;
  return static_cast<std::uint8_t>(60 + std::lround(195 * cosine));
}

}  // namespace

const std::vector<View>& views() {
  static const std::vector<View> all{
      {"aqb8_zero", "aqb8_floor", "AQB8: a zero direction component",
       "zero direction component: slope taken as 1",
       "A sphere from a camera that looks along an axis. The middle column and row have a "
       "component that is exactly 0; its reciprocal's infinite exponent is taken as slope 1.",
       pinhole},
      {"aqb8_shift", "aqb8_floor", "AQB8: 5-bit shift overflows 32 bits",
       "5-bit shift overflows 32 bits (|d| < 2^-16)",
       "The sphere under parallel rays whose x and y components are about 2^-17.", shifted},
      {"aqb8_wrap", "aqb8_nearest", "AQB8: 5-bit exponent wraps",
       "5-bit exponent wraps (|d| <= 2^-32)", "The same with components of 2^-40 and 2^-36.",
       wrapped},
      {"aqb8_far", "aqb8_floor", "AQB8: FP32 cancellation", "FP32 cancellation",
       "The sphere from two million radii away.", far_away},
      {"aqb8_far_nearest", "aqb8_nearest", "AQB8: cancellation, rounding to nearest",
       "FP32 cancellation or rounding to nearest", "The sphere from two million radii away.",
       far_away},
      {"aqb8_order", "aqb8_floor", "AQB8: entry distance too late",
       "dropped when popped: entry distance too late",
       "Two spheres from two million radii away, the inner one smaller by a thousandth: what the "
       "inner one's hit cuts off is not looked at again.",
       shells_far_away},
      {"aqb8_anchor", "aqb8_floor", "AQB8: anchors tested without padding",
       "anchor test: unpadded FP32",
       "A tiled cube from its diagonal, pixels exactly on the tiles' vertices and edges: its "
       "outline "
       "is lost.",
       from_the_diagonal},
      {"literal_far", "a2rt_literal", "A²RT as printed: origin clamped",
       "origin clamped to the group's range, or plain FP32 rounding of shift and scale",
       "The sphere from two million radii away.", far_away},
      {"literal_group", "a2rt_literal", "A²RT as printed: groups tested without padding",
       "group test: unpadded FP32",
       "The tiled cube from inside, straight before a vertex; pixels exactly on the tiles' "
       "vertices "
       "and edges.",
       from_inside}};
  return all;
}

Picture draw(const View& view, std::uint32_t side) {
  const Workload workload = view.make(side);
  const std::vector<Hit> truth = true_hits(workload);
  const std::unique_ptr<RtUnit> unit = make_unit(unit_column(view.column));
  unit->build(workload);
  Picture picture;
  picture.side = static_cast<std::uint32_t>(std::lround(std::sqrt(workload.rays.size())));
  for (std::size_t i = 0; i < workload.rays.size(); ++i) {
    const Ray& ray = workload.rays[i];
    Audit audit;
    const Hit found = unit->trace({&ray, {}}, audit);
    const bool hit = truth[i].state == HitState::kHit;
    picture.shade.push_back(hit ? brightness(workload, ray, truth[i]) : std::uint8_t{0});
    char kind = '.';
    if (hit && found != truth[i] && owes(workload, ray, truth[i], found)) {
      const bool farther = found.state == HitState::kHit;
      const std::string why = blame(audit);
      const bool named = why == view.mechanism;
      kind = farther ? (named ? 'F' : 'f') : (named ? 'L' : 'l');
      ++picture.lost_by_mechanism[why];
      ++(farther ? picture.farther : picture.lost);
    }
    picture.kind.push_back(kind);
    picture.hit_pixels += hit ? 1U : 0U;
  }
  return picture;
}

}  // namespace a2rt::hard
