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

// One inner node. Slots 0..group_count-1 are groups (FP32 boxes in A2rtTree::group_boxes), the rest
// sub nodes, whose integers follow the node in memory (in the tester's block format): a visit then
// touches two or three neighbouring cache lines.
struct alignas(64) A2rtNode {
  bvh::ChildRef children[bvh::kMaxWidth];
  std::uint32_t frame = 0;         // index into A2rtTree::frames of the frame of the children
  std::uint32_t first_record = 0;  // of the children, in the exact records
  std::uint32_t fetch_offset = 0;  // of the children's bytes, from the base
  std::uint32_t group_block = 0;   // index into group_boxes; meaningless without group children
  std::uint8_t count = 0, group_count = 0;
  const std::byte* planes() const { return reinterpret_cast<const std::byte*>(this + 1); }
  std::byte* planes() { return reinterpret_cast<std::byte*>(this + 1); }
};
static_assert(sizeof(A2rtNode) == 64);

struct A2rtFrame {
  arith::GroupFrame frame;
  std::uint32_t offset = 0;  // of the group's record
};

class A2rtTree {
 public:
  bool empty() const { return records_.empty(); }
  bvh::ChildRef root() const { return root_; }
  const bvh::ChildRef* children(std::uint32_t node) const { return this->node(node).children; }
  const A2rtNode& node(std::uint32_t index) const {
    return *std::launder(reinterpret_cast<const A2rtNode*>(lines_.data() + index * stride_));
  }
  // Asks the host's cache for a node that will be visited soon.
  void prefetch(std::uint32_t index) const {
    const Line* at = lines_.data() + index * stride_;
    __builtin_prefetch(at);
    __builtin_prefetch(at + 1);
  }
  std::size_t node_count() const { return lines_.size() / stride_; }
  const A2rtFrame& frame(std::uint32_t index) const { return frames_[index]; }
  const arith::BoxBlock& group_boxes(const A2rtNode& node) const {
    return group_boxes_[node.group_block];
  }
  std::span<const bvh::BvhRecord> exact_children(std::uint32_t node) const {
    return {records_.data() + this->node(node).first_record, this->node(node).count};
  }
  const Box& root_box() const { return records_[0].box; }
  float largest_coordinate() const { return largest_; }
  Address base() const { return base_; }
  void set_base(Address base) { base_ = base; }
  std::span<const std::byte> bytes() const { return layout_.bytes; }

  // Takes the tree's records.
  static A2rtTree mirror(bvh::WideBvh& tree, const bvh::Classification& classes,
                         bvh::A2rtLayout layout, const arith::QBoxTester& tester,
                         const arith::A2rtPrecision& precision);

 private:
  void add_node(const bvh::WideBvh& tree, const bvh::Classification& classes,
                const std::vector<bvh::ChildRef>& refs, std::uint32_t record, std::uint32_t frame,
                const arith::QBoxTester& tester, std::uint32_t index);

  struct alignas(64) Line {
    std::byte bytes[64];
  };
  HugeVector<Line> lines_;  // per node: the node, then its planes
  std::size_t stride_ = 2;  // lines per node
  std::vector<A2rtFrame> frames_;
  std::vector<arith::BoxBlock> group_boxes_;
  std::vector<bvh::BvhRecord> records_;
  bvh::A2rtLayout layout_;
  Address base_;
  bvh::ChildRef root_{};
  float largest_ = 0;
};

}  // namespace a2rt::rt
