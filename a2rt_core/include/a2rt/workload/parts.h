// Parts of the simulated machine that only some workloads call for.
//
// A part is called for when a captured ray, instance or geometry can put it to work. A simulation
// instantiates just those; one that instantiates all of them gives the same cycles, because a part
// that nothing calls for is never given work. In particular:
//   - an instance whose transform is the identity is entered without the transform unit,
//   - a candidate leaves the unit only if the program has a shader, or a ray query, to judge it.
#pragma once

#include <bitset>
#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/workload/workload.h"

namespace a2rt {

enum class Part : std::uint8_t {
  kTriangleTester,
  kIntersectionPath,  // box leaves, and the round trip to intersection shaders
  kAnyHitPath,        // candidates that leave the unit for a shader's verdict
  kTransformUnit,
  kMaskTest,
  kFacingTest,
  kOpacityLogic,
  kGeometryFilter,
  kFirstHitExit,
  kCallStack,        // rays traced by hit or miss shaders
  kInlineTraversal,  // ray queries
  kCallableCalls,
  kTextureUnit
};
inline constexpr std::size_t kPartCount = 13;

class Parts {
 public:
  static Parts all() { return Parts(~std::bitset<kPartCount>{}); }
  Parts() = default;
  bool has(Part part) const { return set_[static_cast<std::size_t>(part)]; }
  void add(Part part) { set_.set(static_cast<std::size_t>(part)); }
  friend bool operator==(const Parts&, const Parts&) = default;

 private:
  explicit Parts(const std::bitset<kPartCount>& set) : set_(set) {}
  std::bitset<kPartCount> set_;
};

// What the workload calls for. Linear in rays, candidates and segments.
Parts parts_called_for(const Workload& workload);

// Name of a part in tables and JSON, e.g. "transform unit"; and what would call for it, e.g.
// "instance with a transform other than the identity".
const char* part_name(Part part);
const char* part_cause(Part part);

// True if a shader or a ray query of the program judges candidates on triangles that are not
// opaque. Without one, such a candidate counts as accepted and never leaves the unit.
bool judges_candidates(const Workload& workload);

}  // namespace a2rt
