// A2RT's records (paper, section IV.B and Fig. 5): group node 45 bytes, sub node 15 bytes.
//
//   group  id 1 | box 24 (FP32 lo, hi) | scales 12 (FP32 x, y, z) | start 4 | end 4
//          (one scale for all axes, precision.scales = "single": 4 bytes, 37 in all)
//   sub    id 1 | box 6 (UINT8 x lo, y lo, z lo, x hi, y hi, z hi) | start 4 | end 4
//   id     bit 7: G (1 group, 0 sub); bits 6..0: L (0000000 inner, 1111111 leaf)
// The id byte leads, so that a reader knows a record's size before it reads on.
// Start and end are byte offsets into the structure's own node region for inner nodes, leaf-order
// primitive slots for leaves. A group leaf (classification's leaf policy `group`) has G = 1 and
// L = 1111111, an extension: the paper prints L = 0000000 for every group. With box_bits other than
// 8 the sub box takes 6 * box_bits bits, rounded up to bytes.
//
// Order: breadth first; the children of a node are contiguous, groups before sub nodes. The root's
// record comes first; a tree that is one leaf has no records.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "a2rt/arith/group_frame.h"
#include "a2rt/arith/quantized_box.h"
#include "a2rt/bvh/classify.h"
#include "a2rt/bvh/wide_bvh.h"

namespace a2rt::bvh {

std::uint32_t a2rt_group_bytes(const arith::A2rtPrecision& precision);  // 45
std::uint32_t a2rt_sub_bytes(const arith::A2rtPrecision& precision);    // 15

// One record, decoded.
struct A2rtRecord {
  bool group = false, leaf = false;
  Box box;                   // groups
  Vec3 scale;                // groups
  arith::QuantizedBox qbox;  // sub nodes
  std::uint32_t start = 0, end = 0;
};

// Told of every record as it is encoded, in the order of the bytes: the root, then per inner
// record, in the order these came, its children.
class A2rtRecordSink {
 public:
  virtual ~A2rtRecordSink() = default;
  // The children of the next inner record follow.
  virtual void next_parent() = 0;
  // `record`: index into WideBvh::records; `offset`: of its bytes; `children`: of its first child.
  virtual void group(std::uint32_t record, std::uint32_t offset, std::uint32_t children,
                     const arith::GroupFrame& frame) = 0;
  virtual void sub(std::uint32_t record, std::uint32_t offset, std::uint32_t children,
                   const arith::QuantizedBox& box) = 0;
};

// Packed bytes of a tree. `alignment`: every sibling range starts at a multiple of it (1 packs as
// the paper counts). One pass over the records; besides the result it needs 4 bytes a record.
// Throws UserError (naming `what` and the node) if a box cannot be encoded, or if the nodes exceed
// the 4 GiB that a 4-byte offset reaches.
std::vector<std::byte> encode_a2rt(const WideBvh& bvh, const Classification& classes,
                                   const arith::A2rtPrecision& precision, std::uint32_t alignment,
                                   const std::string& what, A2rtRecordSink* sink = nullptr);
A2rtRecord decode_a2rt(std::span<const std::byte> bytes, std::uint32_t offset,
                       const arith::A2rtPrecision& precision);

}  // namespace a2rt::bvh
