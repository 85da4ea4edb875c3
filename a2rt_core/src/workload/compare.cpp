#include "a2rt/workload/compare.h"

#include <algorithm>
#include <cmath>

#include "a2rt/workload/driver_triangle.h"
#include "a2rt/workload/ray_rules.h"
#include "a2rt/workload/reference.h"

namespace a2rt {
namespace {

constexpr double kEdgeTolerance = 0x1p-16;
constexpr double kTminTolerance = 0x1p-19;

bool is_hit(const Hit& hit) {
  return hit.state == HitState::kHit || hit.state == HitState::kHitInferred;
}

bool same_primitive(const Hit& a, const Hit& b) {
  return a.primitive == b.primitive && a.geometry == b.geometry && a.instance == b.instance;
}

bool anonymous(const Ray& ray) {
  return (ray.flags & (kRayTerminateOnFirstHit | kRaySkipClosestHit)) != 0 &&
         (ray.flags & kRayQuery) == 0;
}

double largest(const Vec3& v) {
  return std::max({std::fabs(static_cast<double>(v.x)), std::fabs(static_cast<double>(v.y)),
                   std::fabs(static_cast<double>(v.z))});
}

// What a hit was on, in the object space of its instance.
struct Target {
  const Instance* instance = nullptr;
  const Triangle* triangle = nullptr;  // null for a box
  Vec3 origin, dir;                    // the driver's object-space ray
};

Target target_of(const Workload& workload, const Ray& ray, const Hit& hit) {
  Target target;
  const Instance& instance = workload.tlas[ray.tlas].instances.at(hit.instance);
  const Blas& blas = workload.blas.at(instance.blas);
  target.instance = &instance;
  target.origin = driver_transform_point(instance.world_to_object, ray.origin);
  target.dir = driver_transform_direction(instance.world_to_object, ray.dir);
  if (!blas.procedural()) {
    target.triangle = &blas.triangles.at(primitive_slot(blas, hit.geometry, hit.primitive));
  }
  return target;
}

// Smallest barycentric weight over the largest, in FP64; negative outside the triangle.
double edge_distance(const Target& target) {
  double p[3][3];
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t a = 0; a < 3; ++a) {
      p[k][a] =
          static_cast<double>(target.triangle->v[k][a]) - static_cast<double>(target.origin[a]);
    }
  }
  const double d[3] = {target.dir.x, target.dir.y, target.dir.z};
  const auto volume = [&](const double* a, const double* b) {
    return d[0] * (a[1] * b[2] - a[2] * b[1]) + d[1] * (a[2] * b[0] - a[0] * b[2]) +
           d[2] * (a[0] * b[1] - a[1] * b[0]);
  };
  const double w[3] = {volume(p[1], p[2]), volume(p[2], p[0]), volume(p[0], p[1])};
  const double sum = w[0] + w[1] + w[2];
  const double scale = std::max({std::fabs(w[0]), std::fabs(w[1]), std::fabs(w[2])});
  if (scale == 0) {
    return 0;
  }
  const double sign = sum < 0 ? -1 : 1;
  return std::min({sign * w[0], sign * w[1], sign * w[2]}) / scale;
}

bool on_edge(const Workload& workload, const Ray& ray, const Hit& hit) {
  if (!is_hit(hit)) {
    return false;
  }
  const Target target = target_of(workload, ray, hit);
  return target.triangle != nullptr && std::fabs(edge_distance(target)) <= kEdgeTolerance;
}

// Rounding of t: that of the origin and of the point, over the length of the direction.
bool near_tmin(const Ray& ray, const Hit& hit) {
  const double length = std::max(largest(ray.dir), 1e-300);
  const double t = hit.t, tmin = ray.tmin;
  const double rounding = kTminTolerance * (largest(ray.origin) / length + std::fabs(t));
  return is_hit(hit) && std::fabs(t - tmin) <= rounding;
}

// Whether the driver, had its boxes led it there, would have taken this hit with `tmax` as the
// nearest so far.
bool driver_accepts(const Workload& workload, const Ray& ray, const Hit& hit, float tmax) {
  const Target target = target_of(workload, ray, hit);
  if (target.triangle == nullptr) {
    return report_in_range(hit.t, ray.tmin, tmax);
  }
  const DriverTriangleHit found = DriverTriangleTest(target.origin, target.dir)(*target.triangle);
  if (!found.hit || !triangle_in_range(found.t, ray.tmin, tmax)) {
    return false;
  }
  const bool front = faces_front(found.front, target.instance->flags);
  const Blas& blas = workload.blas[target.instance->blas];
  const bool opaque =
      is_opaque(blas.geometries[hit.geometry].opaque, target.instance->flags, ray.flags);
  return !culled_by_facing(front, target.instance->flags, ray.flags) &&
         !culled_by_opacity(opaque, ray.flags) && !masked_out(target.instance->mask, ray.mask);
}

bool tie(const Hit& a, const Hit& b) {
  const double ta = a.t, tb = b.t;
  return std::fabs(ta - tb) <= kTieTolerance * std::max(std::fabs(ta), std::fabs(tb));
}

}  // namespace

const char* match_name(Match match) {
  constexpr std::array<const char*, kMatchKinds> kNames = {
      "same", "unknown", "tie", "tmin_self_hit", "edge", "driver_box_loss", "lost", "other"};
  return kNames.at(static_cast<std::size_t>(match));
}

bool same_answer(const Ray& ray, const Hit& a, const Hit& b) {
  if (!is_hit(a) || !is_hit(b)) {
    return is_hit(a) == is_hit(b);
  }
  return anonymous(ray) || (same_primitive(a, b) && a.t == b.t && a.kind == b.kind);
}

Match compare_hit(const Workload& workload, std::size_t index, const Hit& hit) {
  const Ray& ray = workload.rays[index];
  const Hit& driver = workload.driver_hits[index];
  if (driver.state == HitState::kUnknown) {
    return Match::kUnknown;
  }
  if (same_answer(ray, driver, hit)) {
    return Match::kSame;
  }
  const bool both = is_hit(driver) && is_hit(hit);
  if (both && tie(driver, hit)) {
    return Match::kTie;
  }
  const bool unit_nearer = is_hit(hit) && (!is_hit(driver) || hit.t < driver.t);
  if (unit_nearer && driver_accepts(workload, ray, hit, is_hit(driver) ? driver.t : ray.tmax)) {
    return Match::kDriverBoxLoss;
  }
  if (near_tmin(ray, hit) || near_tmin(ray, driver)) {
    return Match::kTminSelfHit;
  }
  if (on_edge(workload, ray, unit_nearer ? hit : driver)) {
    return Match::kEdge;
  }
  return unit_nearer ? Match::kOther : Match::kLost;
}

void MatchReport::add(const Workload& workload, std::size_t ray, const Hit& hit) {
  const Match match = compare_hit(workload, ray, hit);
  const std::uint64_t before = counts[static_cast<std::size_t>(match)]++;
  if (match != Match::kSame && before < keep) {
    examples.push_back({ray, match, workload.driver_hits[ray], hit});
  }
}

void MatchReport::merge(const MatchReport& other) {
  for (std::size_t i = 0; i < kMatchKinds; ++i) {
    counts[i] += other.counts[i];
  }
  examples.insert(examples.end(), other.examples.begin(), other.examples.end());
  std::stable_sort(examples.begin(), examples.end(),
                   [](const Example& a, const Example& b) { return a.ray < b.ray; });
  std::array<std::size_t, kMatchKinds> kept{};
  std::erase_if(examples,
                [&](const Example& e) { return ++kept[static_cast<std::size_t>(e.match)] > keep; });
}

}  // namespace a2rt
