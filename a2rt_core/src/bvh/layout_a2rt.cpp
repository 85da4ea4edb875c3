#include "a2rt/bvh/layout_a2rt.h"

#include <limits>

#include "a2rt/bvh/packing.h"

namespace a2rt::bvh {
namespace {

constexpr std::uint32_t kGroupBit = 0x80, kLeafField = 0x7f;

// Byte offset of every record: the root, then per inner record its children.
std::vector<std::uint32_t> place(const WideBvh& bvh, const Classification& classes,
                                 std::uint32_t sub_bytes, std::uint32_t alignment,
                                 std::uint64_t& total, const std::string& what) {
  std::vector<std::uint32_t> offset(bvh.records.size(), 0);
  total = kA2rtGroupBytes;
  for (const BvhRecord& parent : bvh.records) {
    if (parent.leaf()) {
      continue;
    }
    total = (total + alignment - 1) / alignment * alignment;
    for (std::uint32_t c = parent.first; c < parent.first + parent.count; ++c) {
      offset[c] = static_cast<std::uint32_t>(total);
      total += classes.is_group[c] != 0 ? kA2rtGroupBytes : sub_bytes;
    }
    if (total > std::numeric_limits<std::uint32_t>::max()) {
      throw UserError(what + ": its nodes exceed the 4 GiB that A2RT's addresses reach");
    }
  }
  return offset;
}

void write_range(ByteWriter& out, const BvhRecord& r, const std::vector<std::uint32_t>& offset,
                 const Classification& classes, std::uint32_t sub_bytes) {
  if (r.leaf()) {
    out.u32(r.first);
    out.u32(r.first + r.count);
    return;
  }
  const std::uint32_t last = r.first + r.count - 1;
  out.u32(offset[r.first]);
  out.u32(offset[last] + (classes.is_group[last] != 0 ? kA2rtGroupBytes : sub_bytes));
}

void write_planes(ByteWriter& out, const arith::QuantizedBox& box, int bits) {
  for (std::size_t a = 0; a < 6; ++a) {
    const std::uint32_t plane = a < 3 ? box.lo[a] : box.hi[a - 3];
    if (bits == 8) {
      out.u8(plane);
    } else {
      out.bits(plane, bits);
    }
  }
  out.align();
}

}  // namespace

std::uint32_t a2rt_sub_bytes(const arith::A2rtPrecision& precision) {
  return static_cast<std::uint32_t>((6 * precision.box_bits + 7) / 8 + 9);
}

A2rtLayout encode_a2rt(const WideBvh& bvh, const Classification& classes,
                       const arith::A2rtPrecision& precision, std::uint32_t alignment,
                       const std::string& what) {
  A2rtLayout layout;
  if (bvh.empty() || bvh.records[0].leaf()) {
    return layout;
  }
  check_boxes(bvh, what);  // names the node; below, every box is known to be encodable
  const std::uint32_t sub_bytes = a2rt_sub_bytes(precision);
  std::uint64_t total = 0;
  layout.offset = place(bvh, classes, sub_bytes, alignment, total, what);
  layout.qbox.resize(bvh.records.size());
  std::vector<arith::GroupFrame> frames;                 // of the groups, in the order written
  std::vector<std::uint32_t> frame(bvh.records.size());  // index into `frames`, groups only
  ByteWriter out(layout.bytes, total);
  const auto write = [&](std::uint32_t i) {
    const BvhRecord& r = bvh.records[i];
    out.pad_to(layout.offset[i]);
    out.u8((classes.is_group[i] != 0 ? kGroupBit : 0U) | (r.leaf() ? kLeafField : 0U));
    if (classes.is_group[i] != 0) {
      frame[i] = static_cast<std::uint32_t>(frames.size());
      frames.push_back(arith::make_group_frame(r.box, precision, what));
      out.box(r.box);
      out.vec3(frames.back().scale);
    } else {
      const std::uint32_t group = classes.group[i];
      layout.qbox[i] =
          arith::quantize_box(r.box, bvh.records[group].box, frames[frame[group]], precision, what);
      write_planes(out, layout.qbox[i], precision.box_bits);
    }
    write_range(out, r, layout.offset, classes, sub_bytes);
  };
  write(0);
  for (const BvhRecord& parent : bvh.records) {
    for (std::uint32_t c = 0; !parent.leaf() && c < parent.count; ++c) {
      write(parent.first + c);
    }
  }
  out.finish();
  return layout;
}

A2rtRecord decode_a2rt(std::span<const std::byte> bytes, std::uint32_t offset,
                       const arith::A2rtPrecision& precision) {
  ByteReader in(bytes, offset);
  A2rtRecord r;
  const std::uint32_t id = in.u8();
  r.group = (id & kGroupBit) != 0;
  r.leaf = (id & kLeafField) == kLeafField;
  if (r.group) {
    r.box = in.box();
    r.scale = in.vec3();
  } else {
    for (std::size_t a = 0; a < 6; ++a) {
      (a < 3 ? r.qbox.lo[a] : r.qbox.hi[a - 3]) =
          static_cast<std::uint16_t>(in.bits(precision.box_bits));
    }
    in.align();
  }
  r.start = in.u32();
  r.end = in.u32();
  return r;
}

}  // namespace a2rt::bvh
