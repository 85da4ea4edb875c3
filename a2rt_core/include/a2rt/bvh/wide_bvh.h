// A wide bounding volume hierarchy, before any unit's encoding.
//
// Every box of the tree is one record, as in the layouts of the A2RT paper (section IV.B): records
// are stored breadth first, and the children of a node are contiguous. Record 0 is the root.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "a2rt/base/vec.h"

namespace a2rt::bvh {

// Widest node any encoding and the SIMD tests provide for.
inline constexpr unsigned kMaxWidth = 8;
// Most primitives in one leaf (a child reference holds the count in four bits).
inline constexpr unsigned kMaxLeaf = 16;

struct BvhRecord {
  Box box;
  std::uint32_t first = 0;  // inner: record of the first child; leaf: first slot of WideBvh::order
  std::uint16_t count = 0;  // children, or primitives
  std::uint16_t is_leaf = 0;
  bool leaf() const { return is_leaf != 0; }
};
static_assert(sizeof(BvhRecord) == 32);

// Tree over primitives 0..n-1. Empty (no records) if there is nothing to hit.
struct WideBvh {
  unsigned width = 0;                // most children of a node
  std::vector<BvhRecord> records;    // breadth first, siblings contiguous
  std::vector<std::uint32_t> order;  // leaf order: primitive index per slot
  unsigned depth = 0;                // edges from the root to the deepest leaf
  double build_seconds = 0;          // of the SAH build, for reports

  bool empty() const { return records.empty(); }
  std::size_t inner_count() const;
  std::size_t leaf_count() const;
};

// Half of a box's surface area; doubles, because FP32 areas of extreme boxes overflow.
double half_area(const Box& box);

// Expected cost of a random ray that meets the root: 1 per inner record visited and 1 per primitive
// tested, weighted by area (Wald 2007). Zero for a tree without area.
double sah_cost(const WideBvh& bvh);

// Inner records are numbered 0, 1, ... in record order; leaves get kNoInner.
inline constexpr std::uint32_t kNoInner = 0xffffffffu;
std::vector<std::uint32_t> number_inner_records(const WideBvh& bvh);

// Throws UserError naming the first record whose box is inverted, NaN, or does not hold a child's;
// `what` says which structure it is ("BLAS 3"). Encoders call it before they touch a box.
void check_boxes(const WideBvh& bvh, const std::string& what);

}  // namespace a2rt::bvh
