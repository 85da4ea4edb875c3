// An A2RT structure as traversed: packed records (bvh/layout_a2rt.h) and their SIMD mirror.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "a2rt/arith/group_frame.h"
#include "a2rt/arith/qbox.h"
#include "a2rt/arith/slab.h"
#include "a2rt/base/units.h"
#include "a2rt/bvh/child_ref.h"
#include "a2rt/bvh/layout_a2rt.h"
#include "a2rt/bvh/wide_bvh.h"

namespace a2rt::rt {

// One inner node. Slots 0..group_count-1 are groups (FP32 boxes in A2rtTree::group_boxes), the rest
// sub nodes (integers in `planes`, in the tester's block format).
struct alignas(64) A2rtNode {
  std::byte planes[96];
  bvh::ChildRef children[bvh::kMaxWidth];
  std::uint32_t frame = 0;         // index into A2rtTree::frames of the frame of the children
  std::uint32_t first_record = 0;  // of the children, in the exact records
  std::uint32_t fetch_offset = 0;  // of the children's bytes, from the base
  std::uint32_t group_block = 0;   // index into group_boxes; meaningless without group children
  std::uint8_t count = 0, group_count = 0;
};

struct A2rtFrame {
  arith::GroupFrame frame;
  std::uint32_t offset = 0;  // of the group's record
};

class A2rtTree {
 public:
  bool empty() const { return records_.empty(); }
  bvh::ChildRef root() const { return root_; }
  const bvh::ChildRef* children(std::uint32_t node) const { return nodes_[node].children; }
  const A2rtNode& node(std::uint32_t index) const { return nodes_[index]; }
  std::size_t node_count() const { return nodes_.size(); }
  const A2rtFrame& frame(std::uint32_t index) const { return frames_[index]; }
  const arith::BoxBlock& group_boxes(const A2rtNode& node) const {
    return group_boxes_[node.group_block];
  }
  std::span<const bvh::BvhRecord> exact_children(std::uint32_t node) const {
    return {records_.data() + nodes_[node].first_record, nodes_[node].count};
  }
  const Box& root_box() const { return records_[0].box; }
  float largest_coordinate() const { return largest_; }
  Address base() const { return base_; }
  void set_base(Address base) { base_ = base; }
  std::span<const std::byte> bytes() const { return layout_.bytes; }

  static A2rtTree mirror(const bvh::WideBvh& tree, const bvh::Classification& classes,
                         bvh::A2rtLayout layout, const arith::QBoxTester& tester,
                         const arith::A2rtPrecision& precision);

 private:
  void add_node(const bvh::WideBvh& tree, const bvh::Classification& classes,
                const std::vector<bvh::ChildRef>& refs, std::uint32_t record, std::uint32_t frame,
                const arith::QBoxTester& tester);

  std::vector<A2rtNode> nodes_;
  std::vector<A2rtFrame> frames_;
  std::vector<arith::BoxBlock> group_boxes_;
  std::vector<bvh::BvhRecord> records_;
  bvh::A2rtLayout layout_;
  Address base_;
  bvh::ChildRef root_{};
  float largest_ = 0;
};

}  // namespace a2rt::rt
