// A workload: geometry, rays, what the driver found, and the instruction mix between the rays.
//
// It is what a captured Vulkan program asks of a ray-tracing GPU, independent of any RT unit. All
// units see the same workload (design principle 4). On disk it is HDF5 (see file.h).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "a2rt/base/vec.h"

namespace a2rt {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Vulkan ray flags (VkRayFlags, same bits as SPIR-V).
enum RayFlag : std::uint32_t {
  kRayOpaque = 0x1,
  kRayNoOpaque = 0x2,
  kRayTerminateOnFirstHit = 0x4,
  kRaySkipClosestHit = 0x8,
  kRayCullBackFacing = 0x10,
  kRayCullFrontFacing = 0x20,
  kRayCullOpaque = 0x40,
  kRayCullNoOpaque = 0x80,
  kRaySkipTriangles = 0x100,
  kRaySkipAabbs = 0x200,
  // Not Vulkan's, set by the importer:
  kRayQuery = 0x40000000,      // OpRayQuery*; a candidate that no verdict names is not a hit
  kRayOverridden = 0x80000000  // a verdict was applied: the driver's hit is the unit's
};
inline constexpr std::uint32_t kVulkanRayFlags = 0xffff;

// Vulkan instance flags (VkGeometryInstanceFlagsKHR).
enum InstanceFlag : std::uint32_t {
  kInstanceCullDisable = 0x1,
  kInstanceFlipFacing = 0x2,
  kInstanceForceOpaque = 0x4,
  kInstanceForceNoOpaque = 0x8
};

struct Triangle {
  Vec3 v[3];
};
static_assert(sizeof(Triangle) == 36);

struct Geometry {
  std::uint32_t first = 0;  // first primitive in the BLAS's primitive arrays
  std::uint32_t count = 0;
  bool opaque = false;
};

// One bottom-level structure: triangles or boxes, never both (Vulkan's rule). Primitive p of
// geometry g is entry geometries[g].first + p; that entry index is the "primitive slot".
struct Blas {
  std::vector<Triangle> triangles;
  std::vector<Box> aabbs;
  std::vector<Geometry> geometries;
  std::vector<std::byte> driver_nodes;  // the driver's own tree, for the exact walk; may be empty

  bool procedural() const { return !aabbs.empty(); }
  std::uint32_t primitive_count() const {
    return static_cast<std::uint32_t>(procedural() ? aabbs.size() : triangles.size());
  }
};

struct Instance {
  Affine object_to_world;
  Affine world_to_object;      // the driver's inverse, bit for bit
  std::uint32_t blas = kNone;  // index into Workload::blas; kNone = inactive
  std::uint32_t custom_index = 0;
  std::uint32_t mask = 0xff;
  std::uint32_t sbt_offset = 0;
  std::uint32_t flags = 0;  // InstanceFlag
};

struct Tlas {
  std::vector<Instance> instances;
  std::vector<std::byte> driver_nodes;
};

struct Ray {
  Vec3 origin;
  float tmin = 0;
  Vec3 dir;
  float tmax = std::numeric_limits<float>::infinity();
  std::uint32_t flags = 0;  // RayFlag
  std::uint32_t mask = 0xff;
  std::uint32_t tlas = 0;        // index into Workload::tlas
  std::uint32_t sbt = 0;         // offset | stride << 4 | miss index << 8
  std::uint32_t dispatch = 0;    // index into Workload::dispatches
  std::uint32_t launch = 0;      // linear launch id
  std::uint32_t ordinal = 0;     // how many rays of this launch id came before
  std::uint32_t parent = kNone;  // ray whose shader traced this one
};

enum class HitState : std::uint32_t {
  kMiss = 0,
  kHit = 1,
  kHitInferred = 2,  // hit known to exist, ids from traversal: the shader was skipped or null
  kUnknown = 3
};

// What was found for one ray, by the driver or by a unit. Ids are Vulkan's gl_ builtins.
struct Hit {
  HitState state = HitState::kMiss;
  float t = 0;
  std::uint32_t instance = kNone;  // index into Tlas::instances
  std::uint32_t geometry = kNone;
  std::uint32_t primitive = kNone;
  std::uint32_t kind = 0;  // gl_HitKindEXT: 0xFE front, 0xFF back, or the reported kind
  friend bool operator==(const Hit&, const Hit&) = default;
};

// A candidate that a shader judged: an any-hit verdict, or a reported intersection.
struct Candidate {
  std::uint32_t instance = kNone, geometry = kNone, primitive = kNone;
  float t = 0;
  std::uint32_t kind = 0;
  std::uint32_t verdict = 0;  // any-hit: capture::AnyHitVerdict; report: 1 accepted, 0 not
  std::uint32_t is_report = 0;
};

// Work a launch id does between two rays.
struct Segment {
  std::uint32_t launch = 0;
  std::uint32_t shader = 0;               // index into Workload::shaders
  std::array<std::uint32_t, 8> counts{};  // by capture::Counter
  std::uint32_t ray = kNone;              // ray traced at the end; kNone: invocation ends
};

struct Shader {
  std::uint32_t stage = 0;  // capture::Stage
  std::uint64_t hash = 0;
  std::string entry;
};

struct Dispatch {
  std::uint32_t frame = 0;
  std::uint32_t width = 0, height = 0, depth = 1;
  std::uint64_t first_ray = 0, ray_count = 0;          // rays sorted by launch, then program order
  std::uint64_t first_segment = 0, segment_count = 0;  // segments likewise
};

struct Provenance {
  std::string program, driver, command_line, scene, workload, refused;
  bool tree_rebuilt = false;
};

struct Workload {
  Provenance provenance;
  std::vector<Blas> blas;
  std::vector<Tlas> tlas;
  std::vector<Dispatch> dispatches;
  std::vector<Shader> shaders;
  std::vector<Ray> rays;
  std::vector<Hit> driver_hits;                // one per ray
  std::vector<std::uint64_t> candidate_first;  // rays + 1 entries into candidates
  std::vector<Candidate> candidates;           // grouped by ray, in the driver's order
  std::vector<Segment> segments;
};

}  // namespace a2rt
