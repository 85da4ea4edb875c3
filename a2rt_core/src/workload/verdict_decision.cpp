#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "a2rt/base/error.h"
#include "a2rt/workload/exact_walk.h"
#include "a2rt/workload/ray_rules.h"
#include "a2rt/workload/reference.h"
#include "a2rt/workload/verdicts.h"

namespace a2rt {
namespace {

using capture::VerdictAction;
using capture::VerdictEntry;

bool is_hit(const Hit& hit) {
  return hit.state == HitState::kHit || hit.state == HitState::kHitInferred;
}

// Tells the ray that an entry was decided for. An earlier verdict may change what the program
// traces next, and then an entry of the previous pass belongs to a ray that is gone. It travels in
// VerdictEntry::reserved, which the layer does not look at.
std::uint32_t mark_of(const Ray& ray) {
  const float values[] = {ray.origin.x, ray.origin.y, ray.origin.z, ray.tmin,
                          ray.dir.x,    ray.dir.y,    ray.dir.z,    ray.tmax};
  std::uint32_t hash = 2166136261u;  // FNV-1a over words
  for (const float value : values) {
    hash = (hash ^ std::bit_cast<std::uint32_t>(value)) * 16777619u;
    hash ^= hash >> 15;
  }
  return hash;
}

VerdictEntry entry(VerdictAction action, float tmin = 0, float tmax = 0) {
  return {static_cast<std::uint32_t>(action), tmin, tmax, 0};
}

bool same_entry(const VerdictEntry& a, const VerdictEntry& b) {
  return a.action == b.action && a.tmin == b.tmin && a.tmax == b.tmax;
}

// Whether the program can see which hit it was.
bool sees_ids(const Ray& ray) {
  return (ray.flags & kRaySkipClosestHit) == 0 || (ray.flags & kRayQuery) != 0;
}

class Decider {
 public:
  Decider(const Workload& workload, const VerdictTable& previous, VerdictSummary& summary)
      : workload_(workload), previous_(previous), summary_(summary), walk_(workload) {}

  VerdictEntry decide(std::size_t index, const Hit& unit) {
    const Ray& ray = workload_.rays[index];
    const VerdictEntry before = previous_.find(ray.dispatch, ray.launch, ray.ordinal);
    const bool stands = agrees(ray, workload_.driver_hits[index], unit) ||
                        rests_on_ignorance(index, ray, unit, before);
    VerdictEntry now = stands ? before : changed(index, ray, unit);
    now.reserved = keeps(now) ? 0 : mark_of(ray);
    summary_.entries += keeps(now) ? 0U : 1U;
    summary_.changed += same_entry(now, before) ? 0U : 1U;
    return now;
  }

 private:
  // Whether the recorded outcome, under the previous verdicts, is the unit's.
  static bool agrees(const Ray& ray, const Hit& recorded, const Hit& unit) {
    if (recorded.state == HitState::kUnknown) {
      // With a verdict applied and no record, there was a hit: a miss shader would have said so.
      return (ray.flags & kRayOverridden) == 0 || is_hit(unit);
    }
    if (!is_hit(recorded) || !is_hit(unit)) {
      return is_hit(recorded) == is_hit(unit);
    }
    return !sees_ids(ray) || same_hit(recorded, unit);
  }
  // Under a verdict the driver judges only candidates inside the new interval, and none if a miss
  // is forced. A unit that meets another one takes it for accepted. The pass before, which led to
  // this verdict for this very ray, knew better.
  bool rests_on_ignorance(std::size_t index, const Ray& ray, const Hit& unit,
                          const VerdictEntry& before) const {
    if (keeps(before) || before.reserved != mark_of(ray) || !is_hit(unit)) {
      return false;
    }
    const bool inside = before.action == static_cast<std::uint32_t>(VerdictAction::kInterval) &&
                        unit.t > before.tmin && unit.t < before.tmax;
    return !inside && !opaque(ray, unit) && !judged(index, unit);
  }
  bool opaque(const Ray& ray, const Hit& hit) const {
    const Instance& instance = workload_.tlas[ray.tlas].instances.at(hit.instance);
    const Blas& blas = workload_.blas.at(instance.blas);
    return is_opaque(blas.geometries.at(hit.geometry).opaque, instance.flags, ray.flags);
  }
  bool judged(std::size_t index, const Hit& hit) const {
    const auto all = candidates_of(workload_, index);
    return std::any_of(all.begin(), all.end(), [&](const Candidate& c) {
      return c.primitive == hit.primitive && c.geometry == hit.geometry &&
             c.instance == hit.instance;
    });
  }
  static bool same_hit(const Hit& a, const Hit& b) {
    return a.primitive == b.primitive && a.geometry == b.geometry && a.instance == b.instance &&
           a.t == b.t;
  }

  VerdictEntry changed(std::size_t index, const Ray& ray, const Hit& unit) {
    if (!is_hit(unit)) {
      return entry(VerdictAction::kForceMiss);
    }
    const float inf = std::numeric_limits<float>::infinity();
    const float below = std::max(std::nextafter(unit.t, -inf), ray.tmin);
    // The driver takes the nearest hit, so a late begin is enough; a ray that ends at its first hit
    // also needs an early end, and the driver's boxes need a little room before it.
    const float ends[] = {ray.tmax, unit.t + std::fabs(unit.t) * 0x1p-14f,
                          std::nextafter(unit.t, inf)};
    for (const float end : ends) {
      const float tmax = std::min(end, ray.tmax);
      if (leads_to(index, ray, below, tmax, unit)) {
        return entry(VerdictAction::kInterval, below, tmax);
      }
    }
    ++summary_.unrealisable;
    return entry(VerdictAction::kKeep);
  }

  bool leads_to(std::size_t index, Ray ray, float tmin, float tmax, const Hit& unit) const {
    if (!walk_.problem(ray.tlas).empty()) {
      return true;  // cannot be proved; the next pass will show
    }
    ray.tmin = tmin;
    ray.tmax = tmax;
    const Hit found = walk_.walk(ray, candidates_of(workload_, index)).hit;
    return is_hit(found) && (!sees_ids(ray) || same_hit(found, unit));
  }

  const Workload& workload_;
  const VerdictTable& previous_;
  VerdictSummary& summary_;
  ExactWalk walk_;
};

}  // namespace

std::vector<VerdictEntry> decide_verdicts(const Workload& workload, std::span<const Hit> hits,
                                          const VerdictTable& previous, VerdictSummary& summary) {
  A2RT_CHECK(hits.size() == workload.rays.size(), "one hit per ray");
  Decider decider(workload, previous, summary);
  std::vector<VerdictEntry> entries;
  entries.reserve(hits.size());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    entries.push_back(decider.decide(i, hits[i]));
  }
  return entries;
}

}  // namespace a2rt
