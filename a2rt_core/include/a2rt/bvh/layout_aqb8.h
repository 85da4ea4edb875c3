// AQB8's records (ISCA 2025 artifact): anchor 36 bytes, node 16 or 8 bytes a box.
//
//   anchor   box 24 (FP32 x lo, x hi, y lo, y hi, z lo, z hi) | 128/sx 4 | node offset 4 |
//            triangle offset 4
//   node 8   box 6 (UINT8 x lo, x hi, y lo, y hi, z lo, z hi) | child word 2:
//            bit 15 a, bits 14..12 b, bits 11..0 c; a = 1, b = 0: inner, c = local node;
//            a = 1, b = 1..7: leaf of b triangles, c = local triangle; a = 0: switch to cluster
//            b:c (15 bits). This is the artifact's node; its limits (4096 nodes and triangles a
//            cluster, 32768 clusters, 7 triangles a leaf) hold.
//   node 16  box 6 | kind 1 (0 inner, 1 leaf, 2 switch) | count 1 (children or triangles) |
//            first 4 (global node, triangle or cluster) | first child 4. The size the A2RT paper
//            charges AQB8; its wider words lift the limits.
// A node record is one box; the children of a node are contiguous (order of emission:
// aqb8_clusters.h). In the 8-byte format the number of children is not stored, as in the artifact;
// a reader needs one more source for it (the model takes it from the tree).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "a2rt/arith/aqb8_arith.h"
#include "a2rt/bvh/aqb8_clusters.h"
#include "a2rt/bvh/wide_bvh.h"

namespace a2rt::bvh {

inline constexpr std::uint32_t kAqb8AnchorBytes = 36;
inline constexpr std::uint32_t kAqb8WordCapacity = 4096;
inline constexpr std::uint32_t kAqb8WordClusters = 32768;
inline constexpr std::uint32_t kAqb8MostLeaf = 7;

enum class Aqb8Kind : std::uint8_t { kInner = 0, kLeaf = 1, kSwitch = 2 };

struct Aqb8Record {
  arith::Aqb8Box box;
  Aqb8Kind kind = Aqb8Kind::kInner;
  std::uint32_t first = 0;  // 8-byte nodes: local to the cluster; 16-byte nodes: global
  std::uint32_t count = 0;  // leaf: triangles; 16-byte inner and switch: children
};

struct Aqb8Layout {
  std::vector<std::byte> anchor_bytes;  // cluster c at 36 c
  std::vector<std::byte> node_bytes;    // node at position p at p * record_bytes
  std::vector<arith::Aqb8Anchor> anchors;
  std::vector<arith::Aqb8Box> boxes;  // by position
};

// Throws UserError for record_bytes other than 8 and 16, for leaves of more than 7 triangles, and
// where the artifact asserts; names `what` and the node.
Aqb8Layout encode_aqb8(const WideBvh& bvh, const Clustering& clusters, std::uint32_t record_bytes,
                       const std::string& what, const arith::Aqb8Precision& precision = {});
Aqb8Record decode_aqb8(std::span<const std::byte> node_bytes, std::uint32_t record_bytes,
                       std::uint32_t position);

}  // namespace a2rt::bvh
