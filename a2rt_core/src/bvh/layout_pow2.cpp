#include "a2rt/bvh/layout_pow2.h"

#include <algorithm>

#include "a2rt/bvh/packing.h"

namespace a2rt::bvh {
namespace {

constexpr std::int32_t kExponentBias = 127;
constexpr std::uint32_t kInnerMeta = 0x20 | 24;

void write_frame(ByteWriter& out, const arith::Pow2Frame& frame) {
  out.vec3(frame.lo);
  for (const std::int8_t e : frame.exponent) {
    out.u8(static_cast<std::uint32_t>(e + kExponentBias));
  }
}

arith::Pow2Frame read_frame(ByteReader& in) {
  arith::Pow2Frame frame;
  frame.lo = in.vec3();
  for (std::int8_t& e : frame.exponent) {
    e = static_cast<std::int8_t>(static_cast<std::int32_t>(in.u8()) - kExponentBias);
  }
  return frame;
}

std::uint32_t unary(std::uint32_t count) { return (1U << count) - 1; }

void write_meta(ByteWriter& out, const WideBvh& bvh, const BvhRecord& node,
                std::uint32_t first_triangle, const std::string& what) {
  for (std::uint32_t s = 0; s < bvh.width; ++s) {
    if (s >= node.count) {
      out.u8(0);
      continue;
    }
    const BvhRecord& child = bvh.records[node.first + s];
    if (!child.leaf()) {
      out.u8(kInnerMeta + s);
      continue;
    }
    if (child.count > kCwbvhMostLeaf) {
      throw UserError(what + ", node " + std::to_string(node.first + s) +
                      ": compressed wide nodes hold leaves of at most 3 primitives; set "
                      "tree.max_leaf to 3 or less");
    }
    out.u8(unary(child.count) << 5 | (child.first - first_triangle));
  }
}

std::uint32_t first_leaf_slot(const WideBvh& bvh, const BvhRecord& node) {
  for (std::uint32_t c = node.first; c < node.first + node.count; ++c) {
    if (bvh.records[c].leaf()) {
      return bvh.records[c].first;
    }
  }
  return 0;
}

}  // namespace

bool is_multi_leaf(const WideBvh& bvh, std::uint32_t i) {
  const BvhRecord& r = bvh.records[i];
  const auto first = bvh.records.begin() + r.first;
  return !r.leaf() &&
         std::all_of(first, first + r.count, [](const BvhRecord& c) { return c.leaf(); });
}

std::vector<Box> dequantized_boxes(const WideBvh& bvh, bool only_multi_leaf,
                                   const std::string& what) {
  std::vector<Box> boxes(bvh.records.size());
  if (!bvh.empty()) {
    boxes[0] = bvh.records[0].box;
  }
  for (std::uint32_t i = 0; i < bvh.records.size(); ++i) {
    const BvhRecord& r = bvh.records[i];
    if (r.leaf()) {
      continue;
    }
    const bool quantize = !only_multi_leaf || is_multi_leaf(bvh, i);
    const arith::Pow2Frame frame =
        quantize ? arith::make_pow2_frame(r.box, what) : arith::Pow2Frame{};
    for (std::uint32_t c = r.first; c < r.first + r.count; ++c) {
      const Box& exact = bvh.records[c].box;
      boxes[c] = quantize ? arith::dequantize_pow2(arith::quantize_pow2(exact, frame, what), frame)
                          : exact;
    }
  }
  return boxes;
}

std::vector<std::byte> encode_cwbvh(const WideBvh& bvh, const std::string& what) {
  check_boxes(bvh, what);
  std::vector<std::byte> bytes;
  const std::vector<std::uint32_t> number = number_inner_records(bvh);
  ByteWriter out(bytes);
  for (std::uint32_t i = 0; i < bvh.records.size(); ++i) {
    const BvhRecord& r = bvh.records[i];
    if (r.leaf()) {
      continue;
    }
    const arith::Pow2Frame frame = arith::make_pow2_frame(r.box, what);
    const std::uint32_t first_triangle = first_leaf_slot(bvh, r);
    std::uint32_t mask = 0, first_child = 0;
    for (std::uint32_t s = r.count; s-- > 0;) {
      if (!bvh.records[r.first + s].leaf()) {
        mask |= 1U << s;
        first_child = number[r.first + s];
      }
    }
    write_frame(out, frame);
    out.u8(mask);
    out.u32(first_child);
    out.u32(first_triangle);
    write_meta(out, bvh, r, first_triangle, what);
    std::vector<arith::Pow2Box> boxes(bvh.width);
    for (std::uint32_t s = 0; s < r.count; ++s) {
      boxes[s] = arith::quantize_pow2(bvh.records[r.first + s].box, frame, what);
    }
    for (std::size_t plane = 0; plane < 6; ++plane) {
      for (const arith::Pow2Box& b : boxes) {
        out.u8(plane < 3 ? b.lo[plane] : b.hi[plane - 3]);
      }
    }
  }
  out.finish();
  return bytes;
}

Pow2Node decode_cwbvh(std::span<const std::byte> bytes, unsigned width, std::uint32_t node) {
  ByteReader in(bytes, std::size_t{node} * cwbvh_node_bytes(width));
  Pow2Node result;
  result.frame = read_frame(in);
  in.u8();
  const std::uint32_t first_child = in.u32(), first_triangle = in.u32();
  std::vector<std::uint32_t> meta(width);
  for (std::uint32_t& m : meta) {
    m = in.u8();
  }
  std::vector<arith::Pow2Box> boxes(width);
  for (std::size_t plane = 0; plane < 6; ++plane) {
    for (arith::Pow2Box& b : boxes) {
      (plane < 3 ? b.lo[plane] : b.hi[plane - 3]) = static_cast<std::uint8_t>(in.u8());
    }
  }
  std::uint32_t inner = 0;
  for (unsigned s = 0; s < width && meta[s] != 0; ++s) {
    Pow2Child child;
    child.box = arith::dequantize_pow2(boxes[s], result.frame);
    child.leaf = (meta[s] >> 5) != 1 || (meta[s] & 31U) < 24;
    if (child.leaf) {
      const std::uint32_t ones = meta[s] >> 5;
      child.count = ones == 7 ? 3 : ones == 3 ? 2 : 1;
      child.first = first_triangle + (meta[s] & 31U);
    } else {
      child.first = first_child + inner++;
    }
    result.children.push_back(child);
  }
  return result;
}

std::vector<std::byte> encode_multi_leaf(const WideBvh& bvh, std::uint32_t record,
                                         const std::string& what) {
  const BvhRecord& r = bvh.records[record];
  const arith::Pow2Frame frame = arith::make_pow2_frame(r.box, what);
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  write_frame(out, frame);
  out.u8(r.count);
  out.u32(bvh.records[r.first].first);
  for (std::uint32_t c = r.first; c < r.first + r.count; ++c) {
    const arith::Pow2Box box = arith::quantize_pow2(bvh.records[c].box, frame, what);
    for (std::size_t plane = 0; plane < 6; ++plane) {
      out.u8(plane < 3 ? box.lo[plane] : box.hi[plane - 3]);
    }
    out.u8(bvh.records[c].count);
  }
  out.finish();
  return bytes;
}

Pow2Node decode_multi_leaf(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  Pow2Node node;
  node.frame = read_frame(in);
  const std::uint32_t count = in.u8();
  std::uint32_t first = in.u32();
  for (std::uint32_t c = 0; c < count; ++c) {
    arith::Pow2Box box;
    for (std::size_t plane = 0; plane < 6; ++plane) {
      (plane < 3 ? box.lo[plane] : box.hi[plane - 3]) = static_cast<std::uint8_t>(in.u8());
    }
    const std::uint32_t triangles = in.u8();
    node.children.push_back({arith::dequantize_pow2(box, node.frame), true, first, triangles});
    first += triangles;
  }
  return node;
}

}  // namespace a2rt::bvh
