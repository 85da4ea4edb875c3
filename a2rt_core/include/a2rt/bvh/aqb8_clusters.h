// AQB8's clustering: an exact dynamic program over the finished tree (ISCA 2025 artifact; see the
// description of get_policy and build_int_bvh there).
//
// For each node v below the root and each proper ancestor a of v, with A the half area of v's box
// quantized against a:
//   leaf      T(v|a) = t_ist * count(v) * A
//   stay      T(v|a) = 2 t_trv_int A + sum over children T(c|a)
//   switch    T(v|a) = (2 t_trv_int + t_switch) A + sum over children T(c|v)
// The cheaper wins, a tie stays. "Switch" means that v's children form a new cluster anchored at
// v's FP32 box. O(sum of depths) time and bits.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "a2rt/arith/aqb8_arith.h"
#include "a2rt/bvh/wide_bvh.h"

namespace a2rt::bvh {

struct ClusterConfig {
  double t_trv_int = 0.5;  // cost of one quantized box test
  double t_switch = 0.8;   // cost of an anchor test (0.8 in the 6-wide artifact, 1 in the 2-wide)
  double t_ist = 1;        // cost of a triangle test
  // The 6-wide artifact drops count(v) from the leaf cost; the 2-wide one has it.
  bool leaf_count = true;
  // Nodes (and, separately, triangles) one cluster can address; 4096 with the 16-bit child word.
  // A cluster that would grow beyond it is split: the node whose children do not fit switches. That
  // keeps every address in range at the cost of one anchor, where the artifact aborts.
  std::uint32_t capacity = std::numeric_limits<std::uint32_t>::max();
  // Clusters in all; 32768 with the 16-bit child word. Beyond it: UserError.
  std::uint32_t most_clusters = std::numeric_limits<std::uint32_t>::max();
  // Quantized areas are those that the encoder will store.
  arith::Aqb8Precision precision;
};

struct Cluster {
  std::uint32_t anchor = 0;           // record whose box is the reference
  std::uint32_t node_offset = 0;      // first of its nodes in Clustering::order
  std::uint32_t node_count = 0;       // nodes: the records quantized against the anchor
  std::uint32_t triangle_offset = 0;  // first of its primitives in Clustering::primitives
  std::uint32_t triangle_count = 0;
};

struct Clustering {
  std::vector<Cluster> clusters;          // ids in the order switch nodes are met breadth first
  std::vector<std::uint32_t> order;       // records in emission order: cluster by cluster
  std::vector<std::uint32_t> position;    // per record: its index in `order` (root: kNone value)
  std::vector<std::uint32_t> cluster;     // per record: the cluster its children live in
  std::vector<std::uint8_t> is_switch;    // per record
  std::vector<std::uint32_t> primitives;  // leaf order after emission: slots of WideBvh::order
  std::vector<std::uint32_t> first_primitive;  // per leaf record: first index in `primitives`
  double cost = 0;                             // T of the whole tree
  std::uint64_t capacity_splits = 0;           // switches forced by `capacity`
};

// Throws UserError for more than `most_clusters` clusters, naming the parameters to change.
[[nodiscard]] Clustering cluster_aqb8(const WideBvh& bvh, const ClusterConfig& config);

// Gives `bvh` the clusters' order of primitives: afterwards every leaf's `first` is its entry of
// first_primitive, and `primitives` is the identity.
void adopt_cluster_order(WideBvh& bvh, Clustering& clusters);

// Half area of `box` after quantization against `anchor` and back (the A of the cost model).
double quantized_half_area(const Box& box, const Box& anchor);

}  // namespace a2rt::bvh
