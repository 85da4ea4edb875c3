// Parameters that every unit has: tree, memory layout, order of traversal.
#pragma once

#include <cstdint>

#include "a2rt/bvh/wide_builder.h"
#include "a2rt/config/section.h"

namespace a2rt::rt {

struct TraversalSettings {
  // Children nearest first; off: slot order, the first hit child followed, the others pushed in
  // slot order and popped last first (what Vulkan-Sim does).
  bool front_to_back = true;
  // Popped entries are compared with the closest hit found meanwhile and dropped if beyond it.
  bool retest_on_pop = true;
  // Hit leaves are intersected at once, in slot order, before any inner child (AQB8's artifact).
  bool leaves_at_once = false;
  // The nearest child is followed, but of the others the farthest is popped first (AQB8's 6-wide
  // artifact, and its baseline).
  bool far_first = false;
};

// What a record's access is charged as.
enum class Accounting : std::uint8_t {
  kRecords,    // the bytes read, adjacent records in one read
  kPublished,  // as AQB8's public branches of Vulkan-Sim do, with their slips: see accounting.h
  kCorrected   // the same structures and order of visits, every 64-byte line counted once
};

struct LayoutSettings {
  std::uint32_t region_alignment = 128;  // bytes; structures start at multiples of it
  std::uint32_t sibling_alignment = 1;   // bytes; children of a node start at multiples of it
  std::uint32_t instance_bytes = 64;     // transform 48, BLAS 8, mask, flags, ids
  std::uint32_t id_bytes = 8;            // geometry and primitive id, read once per hit reported
  Accounting accounting = Accounting::kRecords;
  // With kPublished: triangles lie in mesh order behind an array of 4-byte primitive indices.
  bool mesh_order = false;
};

struct UnitSettings {
  bvh::WideBuildConfig tree;
  TraversalSettings traversal;
  LayoutSettings layout;
};

// Reads tables [tree], [layout], [traversal]. `default_leaf`: the unit's own default leaf size and
// `most_leaf` what its records can hold.
UnitSettings read_unit_settings(const config::Section& section, std::int64_t default_leaf = 7,
                                std::int64_t most_leaf = bvh::kMaxLeaf);

// Reads layout.accounting (default: records) for the units that AQB8's public code has, and with
// the other two also takes over its order of visits.
void adopt_accounting(const config::Section& section, UnitSettings& settings,
                      Accounting default_accounting = Accounting::kRecords);

}  // namespace a2rt::rt
