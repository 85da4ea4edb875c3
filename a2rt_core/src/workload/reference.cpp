#include "a2rt/workload/reference.h"

#include <cmath>

#include "a2rt/workload/driver_triangle.h"
#include "a2rt/workload/ray_rules.h"

namespace a2rt {
namespace {

constexpr std::uint32_t kIgnore = 1;  // capture::AnyHitVerdict::kIgnore

bool names(const Candidate& c, std::uint32_t instance, std::uint32_t geometry,
           std::uint32_t primitive) {
  return c.primitive == primitive && c.instance == instance && c.geometry == geometry;
}

// A ray that overflows on its way into an instance is no ray there; no unit traces it.
bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// The search for one ray: what was found so far.
class Search {
 public:
  Search(const Ray& ray, std::span<const Candidate> candidates)
      : ray_(ray), candidates_(candidates) {
    best_.t = ray.tmax;
  }

  void instance(const Instance& instance, std::uint32_t index, const Blas& blas) {
    if (masked_out(instance.mask, ray_.mask)) {
      return;
    }
    for (std::uint32_t g = 0; g < blas.geometries.size(); ++g) {
      const bool opaque = is_opaque(blas.geometries[g].opaque, instance.flags, ray_.flags);
      if (culled_by_opacity(opaque, ray_.flags)) {
        continue;
      }
      if (blas.procedural()) {
        aabbs(blas.geometries[g], index, g);
      } else {
        triangles(blas, instance, index, g, opaque);
      }
    }
  }

  Hit result() const {
    if (best_.primitive == kNone) {
      return {};
    }
    Hit hit = best_;
    const bool anonymous = (ray_.flags & (kRayTerminateOnFirstHit | kRaySkipClosestHit)) != 0;
    hit.state = anonymous ? HitState::kHitInferred : HitState::kHit;
    return hit;
  }

 private:
  void triangles(const Blas& blas, const Instance& instance, std::uint32_t index, std::uint32_t g,
                 bool opaque) {
    if ((ray_.flags & kRaySkipTriangles) != 0) {
      return;
    }
    const Vec3 origin = driver_transform_point(instance.world_to_object, ray_.origin);
    const Vec3 dir = driver_transform_direction(instance.world_to_object, ray_.dir);
    if (!is_finite(origin) || !is_finite(dir)) {
      return;
    }
    const DriverTriangleTest test(origin, dir);
    const Geometry& geometry = blas.geometries[g];
    for (std::uint32_t p = 0; p < geometry.count; ++p) {
      const DriverTriangleHit found = test(blas.triangles[geometry.first + p]);
      if (!found.hit || !triangle_in_range(found.t, ray_.tmin, best_.t)) {
        continue;
      }
      const bool front = faces_front(found.front, instance.flags);
      if (!culled_by_facing(front, instance.flags, ray_.flags) &&
          (opaque || !ignored(index, g, p))) {
        best_ = {HitState::kHit, found.t, index, g, p, front ? kHitKindFront : kHitKindBack};
      }
    }
  }
  void aabbs(const Geometry& geometry, std::uint32_t index, std::uint32_t g) {
    if ((ray_.flags & kRaySkipAabbs) != 0) {
      return;
    }
    for (const Candidate& c : candidates_) {
      if (c.is_report != 0 && c.verdict != 0 && c.instance == index && c.geometry == g &&
          c.primitive < geometry.count && report_in_range(c.t, ray_.tmin, best_.t) &&
          (best_.primitive == kNone || c.t < best_.t)) {
        best_ = {HitState::kHit, c.t, index, g, c.primitive, c.kind};
      }
    }
  }
  bool ignored(std::uint32_t instance, std::uint32_t geometry, std::uint32_t primitive) const {
    for (const Candidate& c : candidates_) {
      if (c.is_report == 0 && names(c, instance, geometry, primitive)) {
        return c.verdict == kIgnore;
      }
    }
    return false;
  }

  const Ray& ray_;
  std::span<const Candidate> candidates_;
  Hit best_;
};

}  // namespace

std::span<const Candidate> candidates_of(const Workload& workload, std::size_t index) {
  if (workload.candidate_first.size() <= index + 1) {
    return {};
  }
  return std::span(workload.candidates)
      .subspan(workload.candidate_first[index],
               workload.candidate_first[index + 1] - workload.candidate_first[index]);
}

Hit reference_hit(const Workload& workload, const Ray& ray, std::span<const Candidate> candidates) {
  Search search(ray, candidates);
  const Tlas& tlas = workload.tlas.at(ray.tlas);
  for (std::uint32_t i = 0; i < tlas.instances.size(); ++i) {
    if (tlas.instances[i].blas != kNone) {
      search.instance(tlas.instances[i], i, workload.blas.at(tlas.instances[i].blas));
    }
  }
  return search.result();
}

}  // namespace a2rt
