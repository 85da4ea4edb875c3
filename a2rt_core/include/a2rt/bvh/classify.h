// A2RT node classification: which boxes open a group and which are quantized inside one (paper
// section III.D, equation 5).
//
// Child c of group G becomes a sub node iff area(c)/area(G) >= S_t and, on every axis,
// length(c)/length(G) >= L_t; else it opens its own group. One pass over the records, parents
// first, O(n): it reads nothing the SAH build does not have at hand (the paper runs it in the
// build; here it is fused with the breadth-first layout instead).
#pragma once

#include <cstdint>
#include <vector>

#include "a2rt/bvh/wide_bvh.h"

namespace a2rt::bvh {

// What becomes of a leaf that fails equation 5 (the paper does not say).
enum class LeafPolicy : std::uint8_t {
  kSub,   // quantized all the same: 15 bytes, a coarser box
  kGroup  // an FP32 box of 45 bytes of its own
};

struct ClassifyConfig {
  double area_ratio = 0.0;    // S_t in [0, 1]
  double length_ratio = 0.0;  // L_t in [0, 1]
  LeafPolicy leaf = LeafPolicy::kSub;
};

struct Classification {
  // Per record: 1 if it opens a group. The root always does, unless it is a leaf.
  std::vector<std::uint8_t> is_group;
  // Per record: record of the group its box is quantized in (sub node) or that it opens (group).
  std::vector<std::uint32_t> group;
  std::uint64_t group_nodes = 0, sub_nodes = 0;
  std::uint64_t inner_nodes = 0;    // groups and sub nodes with children
  std::uint64_t group_parents = 0;  // nodes with at least one group child
};

// Zero-length axes of G, and an area of zero, count as satisfied. Reorders siblings of `bvh`.
[[nodiscard]] Classification classify(WideBvh& bvh, const ClassifyConfig& config);

}  // namespace a2rt::bvh
