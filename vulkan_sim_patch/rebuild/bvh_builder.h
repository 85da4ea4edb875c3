// A binned SAH builder that writes lavapipe's box nodes.
//
// Top-down, three axes, up to 32 bins per axis (Wald, "On fast construction of SAH-based bounding
// volume hierarchies", 2007). The result depends on the items and their order only, never on the
// number of threads: where a subtree's nodes go follows from the number of its leaves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "rebuild/driver_tree.h"

namespace a2rt::layer {

struct BuildItem {
  DriverBox box;
  std::uint32_t leaf;
};

// Where the nodes go and how ids are formed.
struct TreeTarget {
  DriverBoxNode* nodes;  // at least items - 1
  std::uint32_t nodes_offset;
  std::uint32_t leaves_offset;
  std::uint32_t leaf_bytes;
  std::uint32_t leaf_type;
};

// Levels of box nodes that a balanced tree over `leaves` leaves has.
std::uint32_t depth_needed(std::size_t leaves);

// Needs at least two items and depth_limit >= depth_needed(items). Reorders the items.
void build_sah(std::span<BuildItem> items, const TreeTarget& target, std::uint32_t depth_limit,
               unsigned threads);

}  // namespace a2rt::layer
