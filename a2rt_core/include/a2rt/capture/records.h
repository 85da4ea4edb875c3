// The raw capture: what instrumented shaders write and what the importer reads.
//
// The Vulkan layer (vulkan_sim_patch) writes a directory with two files:
//   records.bin   units of 16 bytes (one uvec4 each), appended by the shaders through an atomic
//                 cursor, in no order between launch ids, in program order within one launch id
//   manifest.bin  blocks {BlockHeader, payload} in the order of the Vulkan calls: driver, shaders,
//                 acceleration structures, dispatches (see manifest.h)
//
// This header depends on nothing and uses fixed-width types only. Numbers are never reused.
#pragma once

#include <cstdint>

namespace a2rt::capture {

inline constexpr std::uint32_t kFormatVersion = 1;
inline constexpr std::uint32_t kUnitBytes = 16;

// Kind of a record; in bits 0..7 of word 0 of every record's first unit.
enum class RecordKind : std::uint32_t {
  kRay = 1,          // OpTraceRayKHR or OpRayQueryInitializeKHR
  kHit = 2,          // closest-hit shader entered
  kMiss = 3,         // miss shader entered
  kAnyHit = 4,       // any-hit shader left, with its verdict
  kReport = 5,       // OpReportIntersectionKHR called
  kEnd = 6,          // a shader invocation ended; carries the counters of its last segment
  kSegment = 7,      // counters flushed without a ray (before a callable or a reported hit)
  kQueryStep = 8,    // OpRayQueryProceedKHR returned; committed intersection so far
  kQueryVerdict = 9  // OpRayQueryConfirmIntersection / GenerateIntersection / Terminate
};

// Shader stage, in bits 8..15 of word 0: the SPIR-V execution model of the writing entry point.
enum class Stage : std::uint32_t {
  kRayGeneration = 0,
  kIntersection = 1,
  kAnyHit = 2,
  kClosestHit = 3,
  kMiss = 4,
  kCallable = 5,
  kCompute = 6,
  kFragment = 7,
  kOther = 8
};

// Words 0..3 of every record.
//   word 0  kind | stage << 8 | shader << 16   (shader = index of the ShaderBlock in the manifest)
//   word 1  launch id, linear: x + width * (y + height * z)
//             ray tracing: gl_LaunchID in gl_LaunchSize; compute: the global invocation id in the
//             global size; fragment: the pixel, with width = RecordHeader::launch_width
//   word 2  dispatch index (DispatchBlock of that index in the manifest)
//   word 3  ordinal: how many rays this launch id had begun before this record; in kQueryStep and
//           kQueryVerdict how many it had begun when it had begun the ray of this query, which
//           names the query if several are alive (before that was so, captures counted up to the
//           record)
//
// Then, per kind (units after the first):
//   kRay      u1 origin.xyz tmin
//             u2 dir.xyz tmax
//             u3 flags, mask | sbt_offset << 8 | sbt_stride << 12 | miss_index << 16, site,
//                override
//                (site = trace instruction, numbered through the shader module; override = 1 if a
//                 verdict was applied; origin, tmin, tmax, flags and mask are always those of the
//                 program)
//             u4 u5 the eight counters of the segment that ends with this ray
//   kHit      u1 hit kind, RayTmax, primitive id, instance id
//             u2 geometry index, custom index, 0, 0
//   kMiss     (nothing)
//   kAnyHit   u1, u2 as kHit, with u2.z = AnyHitVerdict
//   kReport   u1, u2 as kHit (u1.y = reported t), with u2.z = 1 if accepted; stands before the
//             kAnyHit of the same candidate
//   kEnd      u1 u2 the eight counters; missing for an intersection shader whose any-hit shader
//             terminated the ray
//   kSegment  u1 u2 the eight counters
//   kQueryStep    u1 committed type (0 none, 1 triangle, 2 generated), t, primitive id, instance id
//                 u2 geometry index, custom index, 1 if Proceed returned true, front face
//                 (all but the first word and the flag are 0 if the type is 0)
//   kQueryVerdict u1 candidate type (0 triangle, 1 AABB), t, primitive id, instance id
//                 u2 geometry index, custom index, AnyHitVerdict (confirm, generate = kAccept), 0
//                 (for kTerminate only u2.z has a meaning)
//
// A kRay directly followed, for its launch id and nesting level, by the parent's next record is a
// ray without shader record: a hit whose closest-hit shader was skipped or is null, or a miss with
// a null miss shader. The importer tells them apart by traversal and marks them as inferred.
inline constexpr std::uint32_t kRayUnits = 6;
inline constexpr std::uint32_t kHitUnits = 3;
inline constexpr std::uint32_t kMissUnits = 1;
inline constexpr std::uint32_t kAnyHitUnits = 3;
inline constexpr std::uint32_t kReportUnits = 3;
inline constexpr std::uint32_t kEndUnits = 3;
inline constexpr std::uint32_t kSegmentUnits = 3;
inline constexpr std::uint32_t kQueryStepUnits = 3;
inline constexpr std::uint32_t kQueryVerdictUnits = 3;

enum class AnyHitVerdict : std::uint32_t { kAccept = 0, kIgnore = 1, kTerminate = 2 };

// Meaning of the eight counters. Units: scalar operations (a vec3 add counts 3) or, for memory,
// 32-bit words; kTexture and kControl count instructions. What each SPIR-V instruction counts
// stands in vulkan_sim_patch/spirv/weights.h.
enum class Counter : std::uint32_t {
  kAlu = 0,
  kSfu = 1,
  kUniformLoad = 2,
  kBufferLoad = 3,
  kBufferStore = 4,
  kTexture = 5,
  kPayload = 6,  // payload, hit attributes, shader record
  kControl = 7
};
inline constexpr std::uint32_t kCounters = 8;

// The 64-byte header page that instrumented shaders read; its address is baked into the SPIR-V.
struct RecordHeader {
  std::uint32_t cursor;            // next free unit (atomic)
  std::uint32_t capacity;          // units in the record buffer
  std::uint32_t lost;              // records that did not fit (atomic)
  std::uint32_t dispatch;          // index of the dispatch being executed
  std::uint64_t records;           // address of unit 0; kSpareUnits more than `capacity` exist
  std::uint64_t ordinals;          // address of ordinal_launches + 1 u32, one per launch id; zeroed
                                   // by ray generation and compute shaders at entry, for fragment
                                   // shaders by the layer (a pixel may be shaded more than once)
  std::uint64_t verdict_index;     // address of {u32 first, u32 count} per launch id, or 0
  std::uint64_t verdicts;          // address of VerdictEntry[]
  std::uint32_t verdict_launches;  // launch ids covered by verdict_index; 0 = no verdicts
  std::uint32_t ordinal_launches;  // launch ids from here on share the last ordinal
  std::uint32_t launch_width;      // pixels per row, for fragment shaders
  std::uint32_t reserved;
};
static_assert(sizeof(RecordHeader) == 64);
// A record that does not fit is counted in RecordHeader::lost; words that a shader replaces in it
// later are written here.
inline constexpr std::uint32_t kSpareUnits = kRayUnits;

// What the unit decides for one ray; entries of a launch id are indexed by ordinal.
enum class VerdictAction : std::uint32_t {
  kKeep = 0,       // the driver's own traversal is right
  kForceMiss = 1,  // trace with cull mask 0
  kInterval = 2    // trace with [tmin, tmax] of the entry: only the unit's own hit is left
};
struct VerdictEntry {
  std::uint32_t action;  // VerdictAction
  float tmin;
  float tmax;
  std::uint32_t reserved;
};
static_assert(sizeof(VerdictEntry) == 16);

// A verdict file (written by the core, read by the layer):
//   VerdictFileHeader, then per dispatch: VerdictDispatchHeader, {u32 first, u32 count} per launch,
//   VerdictEntry[entries]. Launches and ordinals beyond the file are kept as they are.
inline constexpr std::uint32_t kVerdictMagic = 0x56523241;  // "A2RV"
struct VerdictFileHeader {
  std::uint32_t magic;
  std::uint32_t version;  // kFormatVersion
  std::uint32_t dispatches;
  std::uint32_t reserved;
};
struct VerdictDispatchHeader {
  std::uint32_t dispatch;
  std::uint32_t launches;
  std::uint32_t entries;
  std::uint32_t reserved;
};

}  // namespace a2rt::capture
