// Blocks of manifest.bin, the part of a raw capture that the layer's host code writes.
//
// Every block is {BlockHeader, payload of header.bytes bytes}. A reader skips types it does not
// know. Strings are {u32 length, bytes}, no padding. All integers are little-endian.
#pragma once

#include <cstdint>

namespace a2rt::capture {

inline constexpr std::uint32_t kManifestMagic = 0x4d523241;  // "A2RM", first word of the file
// The file starts with {u32 kManifestMagic, u32 kFormatVersion}; then the blocks.

enum class BlockType : std::uint32_t {
  kDriver = 1,    // DriverBlock, then strings: device name, driver name, driver info, command line
  kShader = 2,    // ShaderBlock, then string: entry point name
  kBlas = 3,      // AsBlock, then per geometry GeometryBlock, then per primitive data (see AsBlock)
  kTlas = 4,      // AsBlock, then InstanceBlock[count]
  kAsCopy = 5,    // AsCopyBlock: dst now holds what src held
  kDispatch = 6,  // DispatchBlock, then SiteBinding[site_count]
  kPipeline = 7,  // PipelineBlock, then u32 shader[stage_count] (kUnused: not instrumented),
                  // GroupBlock[group_count]; stages and groups of libraries follow the own ones
  kRefused = 8,   // string: something the layer saw and could not capture, in words
  kEnd = 9,       // EndBlock; a manifest without it was cut off
  kEffects = 10,  // EffectsBlock, then SiteBlock[site_count]: what one shader does with rays
  kAsDestroyed = 11  // AsDestroyedBlock: the program destroyed what stood there
};

struct BlockHeader {
  std::uint32_t type;  // BlockType
  std::uint32_t version;
  std::uint64_t bytes;  // of the payload
};

struct DriverBlock {
  std::uint32_t vendor_id, device_id, driver_id, driver_version;
  std::uint32_t tree_rebuilt;  // 1 if the layer replaced the driver's box nodes
  std::uint32_t reserved[3];
};

struct ShaderBlock {
  std::uint32_t shader;        // index used in the records
  std::uint32_t stage;         // Stage
  std::uint64_t hash;          // FNV-1a of the original SPIR-V words
  std::uint32_t instrumented;  // 1, or 0 if the module was passed through
  std::uint32_t trace_sites;   // number of trace instructions
};

// What a shader can do with rays, from its code alone. Written after the shader's ShaderBlock.
struct EffectsBlock {
  std::uint32_t shader;
  std::uint32_t flags;  // ShaderEffect bits
  std::uint32_t site_count;
  std::uint32_t reserved;
};
enum ShaderEffect : std::uint32_t {
  kUsesRayQuery = 1,
  kExecutesCallable = 2,
  kReportsIntersection = 4,
  kIgnoresIntersection = 8,
  kTerminatesRay = 16,
  kWritesState = 32  // writes memory or payload (decides whether an any-hit depends on the order)
};
// One trace instruction that the shader reaches.
struct SiteBlock {
  std::uint32_t site;
  std::uint32_t is_query;
  std::uint32_t flags_known;  // 1: ray_flags is a constant of the program
  std::uint32_t ray_flags;
  std::uint32_t mask_known;
  std::uint32_t cull_mask;
  std::uint32_t structure;  // 0 unknown, 1 descriptor (set, binding), 2 device address
  std::uint32_t set, binding;
};

// An acceleration structure as built. `id` is unique per build; `address` is its device address.
// kBlas payload after the GeometryBlocks: for triangles, per primitive nine FP32 (three vertices,
// transform applied, in leaf order of the driver); for AABBs six FP32. Then `node_bytes` bytes: the
// driver's own structure from header to last leaf, after the rebuild (0 if the layout is unknown).
// kTlas payload after the InstanceBlocks: `node_bytes` bytes likewise.
struct AsBlock {
  std::uint64_t id;
  std::uint64_t address;
  std::uint32_t geometry_count;  // kBlas; 1 for kTlas
  std::uint32_t count;           // primitives (kBlas) or instances (kTlas)
  std::uint32_t build_flags;     // VkBuildAccelerationStructureFlagsKHR
  std::uint32_t is_update;       // 1: refit or update of the structure at the same address
  std::uint64_t node_bytes;
};

struct GeometryBlock {
  std::uint32_t type;   // 0 triangles, 1 AABBs
  std::uint32_t flags;  // VkGeometryFlagsKHR
  std::uint32_t count;  // primitives
  std::uint32_t reserved;
};

// One instance, with the driver's own inverse (its bits decide the object-space ray).
struct InstanceBlock {
  float object_to_world[3][4];
  float world_to_object[3][4];
  std::uint32_t custom_index;  // 24 bits
  std::uint32_t mask;
  std::uint32_t sbt_offset;
  std::uint32_t flags;         // VkGeometryInstanceFlagsKHR
  std::uint64_t blas_address;  // device address of the BLAS referenced; 0 = inactive
};

struct AsCopyBlock {
  std::uint64_t source_address, destination_address;
  std::uint64_t destination_id;
};

struct AsDestroyedBlock {
  std::uint64_t address;
};

struct DispatchBlock {
  std::uint32_t dispatch;  // index used in the records
  std::uint32_t frame;     // number of submits with traces before this one
  std::uint32_t width, height, depth;
  std::uint32_t kind;  // 0 trace rays, 1 compute with ray queries, 2 draw with ray queries
  std::uint32_t pipeline;
  std::uint32_t site_count;
  std::uint64_t first_unit;  // the records of this dispatch start here in records.bin and end where
                             // those of the next dispatch start
};

// Which TLAS a trace site of a shader uses in one dispatch.
struct SiteBinding {
  std::uint32_t shader;
  std::uint32_t site;
  std::uint64_t tlas_id;  // AsBlock::id; 0 = unknown
};

struct PipelineBlock {
  std::uint32_t pipeline;
  std::uint32_t stage_count;
  std::uint32_t group_count;
  std::uint32_t max_recursion;
  std::uint32_t kind;  // as DispatchBlock::kind
  std::uint32_t reserved;
};
inline constexpr std::uint32_t kUnused = 0xffffffffu;
struct GroupBlock {
  std::uint32_t type;                                         // VkRayTracingShaderGroupTypeKHR
  std::uint32_t general, closest_hit, any_hit, intersection;  // stage index or kUnused
};

struct EndBlock {
  std::uint64_t units;         // units of records.bin in use
  std::uint64_t lost_records;  // did not fit
};

}  // namespace a2rt::capture
