// An A2RT structure as traversed: packed records (bvh/layout_a2rt.h) and their SIMD mirror.
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <string>
#include <vector>

#include "a2rt/arith/group_frame.h"
#include "a2rt/arith/qbox.h"
#include "a2rt/arith/slab.h"
#include "a2rt/base/huge_vector.h"
#include "a2rt/base/units.h"
#include "a2rt/bvh/child_ref.h"
#include "a2rt/bvh/layout_a2rt.h"
#include "a2rt/bvh/wide_bvh.h"

namespace a2rt::rt {

// One inner node, the first of the cache lines that hold all a visit reads, in this order:
//   this header | planes of the sub nodes, in the tester's block format | the frame, if the node
//   opens a group | FP32 boxes of the group children, if there are any
// Slots 0..group_count-1 are groups, the rest sub nodes.
struct alignas(64) A2rtNode {
  bvh::ChildRef children[bvh::kMaxWidth];
  std::uint32_t first_record = 0;   // of the children, in the exact records
  std::uint32_t fetch_offset = 0;   // of the children's bytes, from the base
  std::uint32_t record_offset = 0;  // of the node's own bytes
  std::uint8_t count = 0, group_count = 0;
  bool opens = false;  // it is a group
};
static_assert(sizeof(A2rtNode) == 64);

class A2rtTree {
 public:
  bool empty() const { return records_.empty(); }
  bvh::ChildRef root() const { return root_; }
  // Nodes are named by their first line.
  const A2rtNode& node(std::uint32_t index) const {
    return *std::launder(reinterpret_cast<const A2rtNode*>(lines_.data() + index));
  }
  const bvh::ChildRef* children(std::uint32_t node) const { return this->node(node).children; }
  const std::byte* planes(const A2rtNode& node) const { return part(node, 1); }
  // Nodes that open a group only.
  const arith::GroupFrame& frame(std::uint32_t node) const {
    return *std::launder(
        reinterpret_cast<const arith::GroupFrame*>(part(this->node(node), frame_line_)));
  }
  // Nodes with group children only.
  const arith::BoxBlock& group_boxes(const A2rtNode& node) const {
    return *std::launder(
        reinterpret_cast<const arith::BoxBlock*>(part(node, frame_line_ + (node.opens ? 1 : 0))));
  }
  // Asks the host's cache for a node that will be visited soon.
  void prefetch(bvh::ChildRef ref) const {
    const Line* at = lines_.data() + ref.index();
    __builtin_prefetch(at);
    __builtin_prefetch(at + 1);
    if (ref.opens()) {
      __builtin_prefetch(at + frame_line_);
    }
  }
  std::span<const bvh::BvhRecord> exact_children(std::uint32_t node) const {
    return {records_.data() + this->node(node).first_record, this->node(node).count};
  }
  const Box& root_box() const { return records_[0].box; }
  float largest_coordinate() const { return largest_; }
  Address base() const { return base_; }
  void set_base(Address base) { base_ = base; }
  std::span<const std::byte> bytes() const { return bytes_; }

  // Encodes `tree`, whose records it takes, into packed bytes and their mirror, in one pass.
  static A2rtTree encode(bvh::WideBvh& tree, const bvh::Classification& classes,
                         const arith::QBoxTester& tester, const arith::A2rtPrecision& precision,
                         std::uint32_t sibling_alignment, const std::string& what);

 private:
  class Mirror;
  struct alignas(64) Line {
    std::byte bytes[64];
    Line() {}  // left as the system gives it: every line is written once, by Mirror
  };
  static const std::byte* part(const A2rtNode& node, std::size_t line) {
    return reinterpret_cast<const std::byte*>(&node) + line * sizeof(Line);
  }

  HugeVector<Line> lines_;
  std::size_t frame_line_ = 2;  // 1 + lines of the planes
  std::vector<bvh::BvhRecord> records_;
  std::vector<std::byte> bytes_;
  Address base_;
  bvh::ChildRef root_{};
  float largest_ = 0;
};

}  // namespace a2rt::rt
