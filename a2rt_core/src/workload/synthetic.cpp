#include "a2rt/workload/synthetic.h"

#include <cmath>

#include "a2rt/capture/records.h"
#include "a2rt/workload/driver_layout.h"
#include "a2rt/workload/driver_triangle.h"
#include "a2rt/workload/ray_rules.h"
#include "a2rt/workload/reference.h"
#include "synthetic_shapes.h"

namespace a2rt::synthetic {
namespace {

Blas make_blas(const Config& config, Random& random) {
  Blas blas;
  if (config.shape == Shape::kSpheres) {
    blas.aabbs = make_boxes(config, random);
    blas.geometries.push_back({0, static_cast<std::uint32_t>(blas.aabbs.size()), true});
  } else {
    blas.triangles = make_triangles(config, random);
    const auto count = static_cast<std::uint32_t>(blas.triangles.size());
    const auto masked = static_cast<std::uint32_t>(config.masked_share * count);
    blas.geometries.push_back({0, count - masked, true});
    if (masked > 0) {
      blas.geometries.push_back({count - masked, masked, false});
    }
  }
  return blas;
}

// A point of a random primitive of a random instance, in world space, and a normal there.
struct SurfacePoint {
  Vec3 place, normal;
};
SurfacePoint random_point(const Workload& workload, Random& random) {
  const auto& instances = workload.tlas[0].instances;
  const Instance& instance = instances[random.below(static_cast<std::uint32_t>(instances.size()))];
  const Blas& blas = workload.blas[instance.blas];
  const std::uint32_t slot = random.below(blas.primitive_count());
  Vec3 place, normal;
  if (blas.procedural()) {
    const Box& box = blas.aabbs[slot];
    normal = random.direction();
    const Vec3 centre = mix(box.lo, mix(box.hi, box.lo, -1), 0.5f);
    place = mix(centre, normal, (box.hi.x - box.lo.x) / 2);
  } else {
    const Triangle& t = blas.triangles[slot];
    float u = random.unit(), v = random.unit();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const Vec3 ab = mix(t.v[1], t.v[0], -1), ac = mix(t.v[2], t.v[0], -1);
    place = mix(mix(t.v[0], ab, u), ac, v);
    normal = cross(ab, ac);
  }
  // Good enough for aiming rays: the exact normal would need the inverse transpose.
  const Vec3 turned = driver_transform_direction(instance.object_to_world, normal);
  const bool usable = dot(turned, turned) > 1e-30f;
  return {driver_transform_point(instance.object_to_world, place),
          usable ? normalized(turned) : random.direction()};
}

class RayMaker {
 public:
  RayMaker(const Config& config, Workload& workload, Random& random)
      : config_(config), workload_(workload), random_(random) {}

  void launch(std::uint32_t index) {
    add(index, 0, primary(index));
    for (std::uint32_t k = 0; k < config_.secondary; ++k) {
      add(index, k + 1, secondary(k % 2 == 1));
    }
    workload_.segments.push_back({index, 0, {20, 2, 4, 8, 4, 0, 2, 3}, kNone});
  }

 private:
  Ray primary(std::uint32_t index) const {
    const float reach = config_.instances > 1 ? 4.0f : 1.5f;
    const auto at = [&](std::uint32_t i, std::uint32_t n) {
      return 2 * (static_cast<float>(i) + 0.5f) / static_cast<float>(n) - 1;
    };
    const Vec3 eye{0.3f * reach, 0.2f * reach, 2.5f * reach};
    const Vec3 target{at(index % config_.width, config_.width) * reach,
                      at(index / config_.width, config_.height) * reach, 0};
    Ray ray;
    ray.origin = eye;
    ray.dir = normalized(mix(target, eye, -1));
    ray.tmin = 1e-3f;
    ray.tmax = 1e4f;
    return ray;
  }
  Ray secondary(bool shadow) {
    const SurfacePoint from = random_point(workload_, random_);
    Ray ray;
    ray.origin = mix(from.place, from.normal, 1e-3f);
    ray.tmin = 1e-3f;
    if (shadow) {
      const SurfacePoint to = random_point(workload_, random_);
      ray.dir = mix(to.place, ray.origin, -1);
      ray.tmax = 0.999f;
      ray.flags = kRayTerminateOnFirstHit | kRaySkipClosestHit;
    } else {
      ray.dir = normalized(mix(from.normal, random_.direction(), 0.999f));
      ray.tmax = 1e4f;
    }
    return ray;
  }
  void add(std::uint32_t launch, std::uint32_t ordinal, Ray ray) {
    ray.launch = launch;
    ray.ordinal = ordinal;
    const auto index = static_cast<std::uint32_t>(workload_.rays.size());
    workload_.segments.push_back(
        {launch, 0, {30 + random_.below(40), 2, 6, 4, 0, ordinal % 2, 4, 5}, index});
    workload_.rays.push_back(ray);
  }

  const Config& config_;
  Workload& workload_;
  Random& random_;
};

// Nearest point of the unit-direction-free quadratic, as an intersection shader would report it.
void report_sphere(const Box& box, const Vec3& origin, const Vec3& dir, const Ray& ray,
                   Candidate candidate, std::vector<Candidate>& out) {
  const Vec3 centre = mix(box.lo, mix(box.hi, box.lo, -1), 0.5f);
  const float radius = (box.hi.x - box.lo.x) / 2;
  const Vec3 away = mix(origin, centre, -1);
  const double a = dot(dir, dir), b = dot(away, dir);
  const double c = static_cast<double>(dot(away, away)) - static_cast<double>(radius) * radius;
  const double discriminant = b * b - a * c;
  if (discriminant < 0) {
    return;
  }
  candidate.t = static_cast<float>((-b - std::sqrt(discriminant)) / a);
  candidate.kind = 0;
  candidate.is_report = 1;
  candidate.verdict = report_in_range(candidate.t, ray.tmin, ray.tmax) ? 1 : 0;
  out.push_back(candidate);
}

void add_candidates(const Workload& workload, const Ray& ray, std::vector<Candidate>& out) {
  const auto& instances = workload.tlas[0].instances;
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    const Blas& blas = workload.blas[instances[i].blas];
    if (masked_out(instances[i].mask, ray.mask)) {
      continue;
    }
    const Vec3 origin = driver_transform_point(instances[i].world_to_object, ray.origin);
    const Vec3 dir = driver_transform_direction(instances[i].world_to_object, ray.dir);
    const DriverTriangleTest test(origin, dir);
    for (std::uint32_t g = 0; g < blas.geometries.size(); ++g) {
      const Geometry& geometry = blas.geometries[g];
      for (std::uint32_t p = 0; p < geometry.count; ++p) {
        if (blas.procedural()) {
          report_sphere(blas.aabbs[geometry.first + p], origin, dir, ray, {i, g, p}, out);
        } else if (!geometry.opaque) {
          const DriverTriangleHit hit = test(blas.triangles[geometry.first + p]);
          if (hit.hit && triangle_in_range(hit.t, ray.tmin, ray.tmax)) {
            const bool front = faces_front(hit.front, instances[i].flags);
            out.push_back({i, g, p, hit.t, front ? kHitKindFront : kHitKindBack, p % 2, 0});
          }
        }
      }
    }
  }
}

}  // namespace

Workload make(const Config& config) {
  Random random(config.seed);
  Workload workload;
  workload.provenance.program = "synthetic";
  workload.blas.push_back(make_blas(config, random));
  workload.tlas.push_back({make_instances(config, random), {}});
  workload.shaders.push_back(
      {static_cast<std::uint32_t>(capture::Stage::kRayGeneration), config.seed, "main"});
  RayMaker rays(config, workload, random);
  for (std::uint32_t i = 0; i < config.width * config.height; ++i) {
    rays.launch(i);
  }
  workload.dispatches.push_back(
      {0, config.width, config.height, 1, 0, workload.rays.size(), 0, workload.segments.size()});
  const bool judged = config.masked_share > 0 || config.shape == Shape::kSpheres;
  workload.candidate_first.push_back(0);
  for (const Ray& ray : workload.rays) {
    if (judged) {
      add_candidates(workload, ray, workload.candidates);
    }
    workload.candidate_first.push_back(workload.candidates.size());
  }
  Hit unknown;
  unknown.state = HitState::kUnknown;
  workload.driver_hits.assign(workload.rays.size(), unknown);
  for (std::size_t i = 0; config.reference && i < workload.rays.size(); ++i) {
    workload.driver_hits[i] = reference_hit(workload, workload.rays[i], candidates_of(workload, i));
  }
  if (config.driver_nodes) {
    workload.blas[0].driver_nodes = driver::build_blas(workload.blas[0]);
    workload.tlas[0].driver_nodes = driver::build_tlas(workload.tlas[0], workload.blas);
  }
  return workload;
}

}  // namespace a2rt::synthetic
