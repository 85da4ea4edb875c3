// The closest hit by trying every primitive: slow, obviously right, and independent of any tree.
#pragma once

#include <span>

#include "a2rt/workload/workload.h"

namespace a2rt {

// Closest hit of `ray` over all primitives of its TLAS, with the driver's triangle test and the
// shaders' verdicts in `candidates` (a candidate that no verdict names is accepted; an AABB is hit
// only where an intersection was reported). Of several hits at the same t the first in order of
// (instance, geometry, primitive) is returned. kRayTerminateOnFirstHit is ignored: the closest hit
// is one of the hits such a ray may return. An instance in whose space the ray overflows is not
// hit.
Hit reference_hit(const Workload& workload, const Ray& ray, std::span<const Candidate> candidates);

// Candidates of ray `index`.
std::span<const Candidate> candidates_of(const Workload& workload, std::size_t index);

// Primitive slot of (geometry, primitive) in a BLAS, or kNone if there is none.
inline std::uint32_t primitive_slot(const Blas& blas, std::uint32_t geometry,
                                    std::uint32_t primitive) {
  if (geometry >= blas.geometries.size() || primitive >= blas.geometries[geometry].count) {
    return kNone;
  }
  return blas.geometries[geometry].first + primitive;
}

}  // namespace a2rt
