#include "a2rt/hard/judge.h"

#include <algorithm>

#include "a2rt/arith/oracle.h"
#include "a2rt/arith/slab.h"
#include "a2rt/base/error.h"
#include "a2rt/rt/functional.h"
#include "a2rt/workload/driver_triangle.h"
#include "a2rt/workload/reference.h"

namespace a2rt::hard {
namespace {

constexpr const char* kNoDecision = "dropped when popped: entry distance too late";

void judge_hit(const Workload& workload, const Ray& ray, const Hit& truth, const Hit& found,
               const Audit& audit, Cell& cell) {
  if (found == truth) {
    return;
  }
  if (truth.state == HitState::kHit && !owes(workload, ray, truth, found)) {
    ++cell.rounding_ties;
    return;
  }
  ++cell.lost;
  ++cell.lost_by_mechanism[blame(audit)];
}

}  // namespace

std::string name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kExact:
      return "exact";
    case Verdict::kConservative:
      return "conservative";
    case Verdict::kMisses:
      return "misses";
    case Verdict::kRefuses:
      return "refuses";
  }
  return "";
}

Verdict Cell::verdict() const {
  if (!refusal.empty()) {
    return Verdict::kRefuses;
  }
  if (missed() > 0 || lost > 0) {
    return Verdict::kMisses;
  }
  return redundant() > 0 ? Verdict::kConservative : Verdict::kExact;
}

bool owes(const Workload& workload, const Ray& ray, const Hit& truth, const Hit& found) {
  const float limit = found.state == HitState::kHit ? std::min(found.t, ray.tmax) : ray.tmax;
  const Instance& instance = workload.tlas[ray.tlas].instances[truth.instance];
  const Blas& blas = workload.blas[instance.blas];
  Box box;
  for (const Vec3& v : blas.triangles[primitive_slot(blas, truth.geometry, truth.primitive)].v) {
    box.include(v);
  }
  const arith::OracleRay exact(driver_transform_point(instance.world_to_object, ray.origin),
                               driver_transform_direction(instance.world_to_object, ray.dir),
                               ray.tmin);
  return arith::ray_meets_box(exact, box, limit);
}

std::string blame(const Audit& audit) {
  const auto most =
      std::max_element(audit.missed_by_mechanism.begin(), audit.missed_by_mechanism.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == audit.missed_by_mechanism.end() ? kNoDecision : most->first;
}

std::vector<Hit> true_hits(const Workload& workload) {
  std::vector<Hit> hits;
  hits.reserve(workload.rays.size());
  for (std::size_t i = 0; i < workload.rays.size(); ++i) {
    const Ray& ray = workload.rays[i];
    hits.push_back(arith::ray_is_active(ray.origin, ray.dir, ray.tmin, ray.tmax)
                       ? reference_hit(workload, ray, candidates_of(workload, i))
                       : Hit{});
  }
  return hits;
}

Cell judge(const UnitColumn& column, const Workload& workload, const std::vector<Hit>& truth) {
  Cell cell;
  const std::unique_ptr<RtUnit> unit = make_unit(column);
  try {
    unit->build(workload);
  } catch (const UserError& error) {
    cell.refusal = error.what();
    return cell;
  }
  for (std::size_t i = 0; i < workload.rays.size(); ++i) {
    Audit audit;
    const Hit found = unit->trace({&workload.rays[i], candidates_of(workload, i)}, audit);
    judge_hit(workload, workload.rays[i], truth[i], found, audit, cell);
    rt::add_audit(cell.audit, audit);
    ++cell.rays;
  }
  return cell;
}

}  // namespace a2rt::hard
