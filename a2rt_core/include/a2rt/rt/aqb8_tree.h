// An AQB8 structure as traversed: packed anchors and nodes (bvh/layout_aqb8.h) and a mirror.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "a2rt/arith/aqb8_arith.h"
#include "a2rt/base/huge_vector.h"
#include "a2rt/base/units.h"
#include "a2rt/bvh/aqb8_clusters.h"
#include "a2rt/bvh/child_ref.h"
#include "a2rt/bvh/layout_aqb8.h"
#include "a2rt/bvh/wide_bvh.h"

namespace a2rt::rt {

// One inner node: where its children are, and the boxes at their positions and the next ones.
struct alignas(64) Aqb8Node {
  arith::Aqb8Block boxes;
  std::uint32_t first = 0;  // position of the first child in the emission order
  std::uint32_t cluster = 0;
  std::uint32_t first_record = 0;
  std::uint32_t count = 0;
};
static_assert(sizeof(Aqb8Node) == 64);

class Aqb8Tree {
 public:
  bool empty() const { return records_.empty(); }
  bvh::ChildRef root() const { return root_; }
  // Children by slot; the slots after the last are the nodes that follow in the cluster.
  const bvh::ChildRef* children(std::uint32_t node) const {
    return refs_.data() + nodes_[node].first;
  }
  const Aqb8Node& node(std::uint32_t index) const { return nodes_[index]; }
  // Asks the host's cache for a node that will be visited soon.
  void prefetch(bvh::ChildRef ref) const { __builtin_prefetch(nodes_.data() + ref.index()); }
  std::size_t node_count() const { return nodes_.size(); }
  const arith::Aqb8Box& box(std::uint32_t position) const { return layout_.boxes[position]; }
  const arith::Aqb8Anchor& anchor(std::uint32_t cluster) const { return layout_.anchors[cluster]; }
  const bvh::Cluster& cluster(std::uint32_t index) const { return clusters_[index]; }
  std::span<const bvh::BvhRecord> exact_children(std::uint32_t node) const {
    return {records_.data() + nodes_[node].first_record, nodes_[node].count};
  }
  const bvh::BvhRecord& anchor_record(std::uint32_t cluster) const {
    return records_[clusters_[cluster].anchor];
  }
  Address anchor_base() const { return anchor_base_; }
  Address node_base() const { return node_base_; }
  void set_bases(Address anchors, Address nodes) {
    anchor_base_ = anchors;
    node_base_ = nodes;
  }
  const bvh::Aqb8Layout& layout() const { return layout_; }

  static Aqb8Tree mirror(bvh::WideBvh& tree, const bvh::Clustering& clusters,
                         bvh::Aqb8Layout layout);

 private:
  HugeVector<Aqb8Node> nodes_;
  std::vector<bvh::ChildRef> refs_;  // by position
  std::vector<bvh::Cluster> clusters_;
  std::vector<bvh::BvhRecord> records_;
  bvh::Aqb8Layout layout_;
  Address anchor_base_, node_base_;
  bvh::ChildRef root_{};
};

}  // namespace a2rt::rt
