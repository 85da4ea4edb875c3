// Trees whose children are tested as FP32 boxes: the baseline's own, and those of the compressed
// layouts after dequantization. The packed bytes stay beside a mirror that suits SIMD.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "a2rt/arith/slab.h"
#include "a2rt/base/huge_vector.h"
#include "a2rt/bvh/address_space.h"
#include "a2rt/bvh/child_ref.h"
#include "a2rt/bvh/wide_bvh.h"
#include "a2rt/rt/event.h"

namespace a2rt::rt {

// One inner node: its children's boxes as tested, and where their records lie.
struct alignas(64) BoxNode {
  arith::BoxBlock boxes;
  bvh::ChildRef children[bvh::kMaxWidth];
  std::uint32_t first_record = 0;  // of the children, in BoxTree::records
  std::uint32_t fetch_bytes = 0;   // read when the node is visited
  std::uint64_t fetch_offset = 0;  // from BoxTree::base
  std::uint8_t count = 0;
  bool dequantized = false;  // boxes were rebuilt from integers
};

class BoxTree {
 public:
  bool empty() const { return records_.empty(); }
  bvh::ChildRef root() const { return root_; }
  const bvh::ChildRef* children(std::uint32_t node) const { return nodes_[node].children; }
  const BoxNode& node(std::uint32_t index) const { return nodes_[index]; }
  // Asks the host's cache for a node that will be visited soon.
  void prefetch(bvh::ChildRef ref) const {
    const char* at = reinterpret_cast<const char*>(nodes_.data() + ref.index());
    __builtin_prefetch(at);
    __builtin_prefetch(at + 64);
    __builtin_prefetch(at + 128);
    __builtin_prefetch(at + 192);
  }
  std::size_t node_count() const { return nodes_.size(); }
  std::span<const bvh::BvhRecord> exact_children(std::uint32_t node) const {
    return {records_.data() + nodes_[node].first_record, nodes_[node].count};
  }
  float largest_coordinate() const { return largest_; }
  Address base() const { return base_; }
  std::span<const std::byte> bytes() const { return bytes_; }

  // Mirror of `tree`, whose records it takes, with the tested boxes `boxes` (per record; the
  // records' own if empty). The caller then sets each node's fetch range and hands over the packed
  // bytes.
  static BoxTree mirror(bvh::WideBvh& tree, const std::vector<Box>& boxes);
  BoxNode& mutable_node(std::uint32_t index) { return nodes_[index]; }
  void set_memory(std::vector<std::byte> bytes, Address base) {
    bytes_ = std::move(bytes);
    base_ = base;
  }

 private:
  HugeVector<BoxNode> nodes_;  // inner records in record order
  std::vector<bvh::BvhRecord> records_;
  std::vector<std::byte> bytes_;
  Address base_;
  bvh::ChildRef root_{};
  float largest_ = 0;  // largest |coordinate| of any tested plane
};

}  // namespace a2rt::rt
