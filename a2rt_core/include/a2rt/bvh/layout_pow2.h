// Records of the two compressed layouts that dequantize to FP32 before the test: the compressed
// wide BVH and the compressed-leaf BVH. One record per inner node.
//
// cwbvh (Ylitie, Karras, Laine, HPG 2017, section 3): 80 bytes at width 8, generally 24 + 7 width:
//   corner 12 (FP32) | exponents 3 | inner mask 1 | first child node 4 | first triangle 4 |
//   meta, one byte a child | planes, width bytes each: x lo, y lo, z lo, x hi, y hi, z hi
//   meta: 0 empty; inner 001sssss with sssss = 24 + slot; leaf: unary count in bits 7..5, offset
//   from the first triangle in bits 4..0. So leaves hold at most 3 triangles.
//   Children keep the tree's slots; the paper's octant-based slot assignment orders visits without
//   distances, here every unit sorts by distance alike. Inner children's records are contiguous.
//
// clbvh (Benthin, Wald, Woop, Afra, HPG 2018): where all children of a node are leaves, one
// compressed multi-leaf node holds their quantized boxes; all other boxes stay FP32 records as in
// the baseline (layout_fp32.h).
//   multi-leaf node: corner 12 (FP32) | exponents 3 | children 1 | first triangle 4 |
//   per child: planes 6 (x lo, y lo, z lo, x hi, y hi, z hi), triangles 1
//   = 20 + 7 per child. The leaves' triangles are contiguous, so one base and the counts do.
// Exponents are stored as e + 127 in eight bits, FP32's exponent byte (pow2_frame.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "a2rt/arith/pow2_frame.h"
#include "a2rt/bvh/wide_bvh.h"

namespace a2rt::bvh {

inline constexpr std::uint32_t kCwbvhMostLeaf = 3;
constexpr std::uint32_t cwbvh_node_bytes(unsigned width) { return 24 + 7 * width; }
constexpr std::uint32_t clbvh_multi_leaf_bytes(unsigned children) { return 20 + 7 * children; }

// One inner record, decoded: boxes as the unit rebuilds them.
struct Pow2Child {
  Box box;
  bool leaf = false;
  std::uint32_t first = 0, count = 0;  // inner: node number; leaf: slots of the leaf order
};
struct Pow2Node {
  arith::Pow2Frame frame;
  std::vector<Pow2Child> children;
};

// Boxes of all non-root records after quantization against their parent and back; `only_multi_leaf`
// quantizes just the children of nodes whose children are all leaves (clbvh), the rest is copied.
std::vector<Box> dequantized_boxes(const WideBvh& bvh, bool only_multi_leaf,
                                   const std::string& what);
// True for inner record i if all its children are leaves.
bool is_multi_leaf(const WideBvh& bvh, std::uint32_t i);

// Node n (inner records numbered in record order) at n * cwbvh_node_bytes(width). Throws UserError
// for leaves of more than 3 primitives.
std::vector<std::byte> encode_cwbvh(const WideBvh& bvh, const std::string& what);
Pow2Node decode_cwbvh(std::span<const std::byte> bytes, unsigned width, std::uint32_t node);

// Bytes of one multi-leaf node, and back.
std::vector<std::byte> encode_multi_leaf(const WideBvh& bvh, std::uint32_t record,
                                         const std::string& what);
Pow2Node decode_multi_leaf(std::span<const std::byte> bytes);

}  // namespace a2rt::bvh
