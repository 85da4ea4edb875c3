// The interface every RT unit implements, and their registry.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "a2rt/base/registry.h"
#include "a2rt/base/units.h"
#include "a2rt/rt/event.h"
#include "a2rt/rt/event_receiver.h"
#include "a2rt/workload/workload.h"

namespace a2rt {

namespace config {
class Section;  // typed view of one TOML table; see config/section.h
}

// What a unit promises about hits.
enum class Promise : std::uint8_t {
  kExact,         // FP32 boxes, conservative slab test
  kConservative,  // quantized, never misses a hit
  kMayMiss        // can lose hits; every loss is counted
};

// The box testers a unit is made of; they decide how many fit into an area and what a test costs.
enum class BoxTesters : std::uint8_t {
  kFp32,        // accurate boxes only
  kCompressed,  // accurate testers, each behind a dequantizer
  kAqb8,        // quantized testers, anchor and update units
  kA2rt         // quantized testers, accurate ones for group boxes, ray quantizers
};

struct UnitInfo {
  std::string name;
  std::string title;   // one line for tables
  std::string source;  // paper and section it implements
  Promise promise = Promise::kExact;
  BoxTesters testers = BoxTesters::kFp32;
};

// Size and cost of the structure a unit traverses.
struct StructureStats {
  double build_seconds = 0;     // SAH build, shared by all units of the same tree
  double classify_seconds = 0;  // grouping or clustering
  double encode_seconds = 0;
  std::uint64_t inner_nodes = 0, leaf_nodes = 0;
  std::uint64_t group_nodes = 0, sub_nodes = 0;  // or anchors and quantized nodes
  std::uint64_t node_bytes = 0, group_bytes = 0, sub_bytes = 0, triangle_bytes = 0, box_bytes = 0;
  std::uint64_t depth = 0;
  double sah_cost = 0;
};

// Decisions of the unit against exact arithmetic (only filled when tracing with an Audit).
struct Audit {
  std::uint64_t box_tests = 0;   // FP32 tests
  std::uint64_t qbox_tests = 0;  // quantized tests
  // Boxes of quantized nodes that were judged: by a quantized test, or in FP32 after an escape.
  // Slots that a design tests beyond a node's children are not among them.
  std::uint64_t decided = 0;
  std::uint64_t exact_hits = 0;      // decided boxes that the ray meets exactly
  std::uint64_t redundant_hits = 0;  // the unit says hit, exact says no
  std::uint64_t missed_hits = 0;     // exact says hit, the unit says no
  // The same three of the FP32 tests: the baseline's nodes, A2RT's group boxes.
  std::uint64_t fp32_exact_hits = 0, fp32_redundant_hits = 0, fp32_missed_hits = 0;
  std::uint64_t escapes = 0;  // boxes
  std::uint64_t triangle_tests = 0;
  // What made a test miss, in words ("5-bit shift overflows"); sums to missed_hits and
  // fp32_missed_hits.
  std::map<std::string, std::uint64_t> missed_by_mechanism;
};

// A structure's place in the simulated GPU's memory.
struct MemoryRegion {
  std::string name;
  Address base;
  Bytes bytes;
};

// One ray as a unit sees it: the ray and the shaders' verdicts on its candidates.
struct RayInput {
  const Ray* ray = nullptr;
  std::span<const Candidate> candidates;  // any-hit verdicts and reported intersections
};

// A modelled RT unit. Immutable after build(); trace() may be called from several threads.
class RtUnit {
 public:
  virtual ~RtUnit() = default;
  virtual const UnitInfo& info() const = 0;

  // Builds and encodes the structures of all BLASes and TLASes. Throws UserError on geometry the
  // encoder must refuse. The workload must outlive the unit.
  virtual void build(const Workload& workload) = 0;
  virtual StructureStats structure() const = 0;
  // Where the structures lie in the simulated memory; empty before build().
  virtual std::vector<MemoryRegion> regions() const { return {}; }

  // Closest hit of one ray (any hit if the flags say so).
  virtual Hit trace(const RayInput& input) const = 0;
  // The same, with the ray's events.
  virtual Hit trace(const RayInput& input, EventReceiver& events) const = 0;
  // The same, appending them to a list.
  Hit trace(const RayInput& input, std::vector<Event>& events) const {
    EventValues list([&events](const Event& event) { events.push_back(event); });
    return trace(input, list);
  }
  // The same, comparing every box decision with exact arithmetic. Slow.
  virtual Hit trace(const RayInput& input, Audit& audit) const = 0;
};

// Units by name. A unit registers itself from its one .cpp with RegisterUnit; its parameters come
// from lumibench_configs/units/NAME.toml.
using UnitRegistry = Registry<RtUnit, const config::Section&>;
UnitRegistry& unit_registry();

struct RegisterUnit {
  RegisterUnit(const std::string& name, UnitRegistry::Factory factory);
};

}  // namespace a2rt
