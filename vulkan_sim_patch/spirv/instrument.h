// Rewrites ray-tracing and ray-query shaders so that they write the records of capture/records.h.
//
// Input and output are SPIR-V modules of any version from 1.0 to 1.6. A module without anything to
// record is returned unchanged, bit for bit. Otherwise the rewritten module needs, from the device,
// the feature bufferDeviceAddress and, for fragment shaders, fragmentStoresAndAtomics.
//
// How it is done: every instrumented entry point becomes a wrapper that sets a Private variable
// with the stage, the shader index and the launch id, writes the records of entry and exit, and
// calls the program's own function. Functions that several entry points share therefore record the
// right shader. Code inserted into the program's functions is straight-line; what must branch or
// loop stands in functions of its own.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "a2rt/capture/records.h"
#include "spirv/error.h"

namespace a2rt::spirv {

// What to record. Everything is on by default; switching one thing off bisects a bad rewrite.
struct InstrumentOptions {
  std::uint64_t header_address = 0;  // device address of the RecordHeader, 16-byte aligned
  bool rays = true;                  // kRay
  bool results = true;               // kHit, kMiss, kQueryStep
  bool candidates = true;            // kAnyHit, kReport, kQueryVerdict
  bool counters = true;              // the eight counters, kEnd, kSegment
  bool verdicts = true;              // look up and apply VerdictEntry per ray
  // Have hidden fragments of a fragment shader discarded before it runs where nobody can tell
  // (see FragmentTests).
  bool early_tests = true;
  // The module's instrumented entry points get consecutive indices from here on, in module order.
  std::uint32_t first_shader_index = 0;
  // Trace sites from this index on are left alone (for bisecting).
  std::uint32_t site_limit = UINT32_MAX;
};

// Value of a specialization constant, as in VkSpecializationInfo; low word of wider constants.
struct Specialization {
  std::uint32_t constant_id = 0;
  std::uint32_t value = 0;
};

// Where a trace instruction takes its acceleration structure from.
struct StructureSource {
  enum class Kind {
    kDescriptor,  // variable at (set, binding)
    kAddress,     // converted from a 64-bit device address
    kUnknown      // not derivable from the module
  };
  Kind kind = Kind::kUnknown;
  std::uint32_t set = 0;
  std::uint32_t binding = 0;
  bool is_array = false;                   // the descriptor is an array of structures ...
  std::optional<std::uint32_t> element{};  // ... and this its element, if constant
  bool operator==(const StructureSource&) const = default;
};

// One OpTraceRayKHR or OpRayQueryInitializeKHR. Sites are numbered through the module in the order
// of the instructions; that number is the `site` of a kRay record.
struct TraceSite {
  std::uint32_t site = 0;
  bool is_query = false;
  bool instrumented = false;  // reached by an instrumented entry point and below site_limit
  StructureSource structure;
  std::optional<std::uint32_t> ray_flags;  // if constant (SPIR-V RayFlags bits)
  std::optional<std::uint32_t> cull_mask;  // if constant, its low 8 bits
};

// Drivers test depth and stencil before a fragment shader that has no effect but its color, and
// after one that writes memory. Rewritten shaders write memory.
enum class FragmentTests {
  kAsBefore,   // the rewrite changes nothing: the program's shader decides when its tests happen
  kMadeEarly,  // early tests are asked for, and only the fragment's color and depth are written;
               // wrong for a pipeline that turns alpha into coverage
  kMadeLate    // the shader also runs for fragments that a driver might have hidden from it
};

struct EntryPoint {
  std::string name;
  std::uint32_t execution_model = 0;  // the SPIR-V number
  capture::Stage stage = capture::Stage::kOther;
  bool instrumented = false;
  std::uint32_t shader = 0;          // index in the records, if instrumented
  std::vector<std::uint32_t> sites;  // trace sites it reaches, ascending
  bool uses_ray_query = false;
  bool executes_callable = false;
  bool reports_intersection = false;
  bool ignores_intersection = false;  // OpIgnoreIntersectionKHR is reachable
  bool terminates_ray = false;        // OpTerminateRayKHR is reachable
  // It stores to, or changes atomically, anything but its own function-local, private and
  // hit-attribute variables. The result of an any-hit shader that does may depend on the order in
  // which candidates are found.
  bool writes_state = false;
  FragmentTests fragment_tests = FragmentTests::kAsBefore;  // set by instrument()
  // Workgroup size of a compute shader; 0 where it depends on a specialization constant that is not
  // known (see `analyse`), and for other stages.
  std::array<std::uint32_t, 3> local_size{};
};

// What a module does with rays.
struct Analysis {
  std::uint32_t version = 0;  // SPIR-V version word, e.g. 0x00010500
  std::vector<EntryPoint> entry_points;
  std::vector<TraceSite> sites;
  std::vector<std::string> warnings;  // e.g. opcodes this build does not know
  // Some entry point is a ray-tracing stage or uses ray queries.
  bool has_rays() const;
};

struct InstrumentResult {
  std::vector<std::uint32_t> words;
  bool instrumented = false;       // false: `words` equals the input
  Analysis analysis;               // with `instrumented` and `shader` filled in
  std::uint32_t shader_count = 0;  // indices used, from first_shader_index on
};

// Both throw SpirvError (see error.h) if the module is damaged; neither crashes on any input.
// `analyse` evaluates flags that depend on specialization constants with `specializations` and the
// constants' defaults otherwise; `instrument` leaves such flags empty.
Analysis analyse(std::span<const std::uint32_t> words,
                 std::span<const Specialization> specializations = {});
InstrumentResult instrument(std::span<const std::uint32_t> words, const InstrumentOptions& options);

}  // namespace a2rt::spirv
