#include "a2rt/bvh/layout_fp32.h"

#include <limits>

#include "a2rt/bvh/packing.h"

namespace a2rt::bvh {
namespace {

// Offsets of all records; `total` becomes the size.
std::vector<std::uint64_t> place(const WideBvh& bvh, std::uint32_t record_bytes,
                                 std::uint32_t alignment, std::uint64_t& total) {
  std::vector<std::uint64_t> offset(bvh.records.size(), 0);
  total = record_bytes;
  for (const BvhRecord& parent : bvh.records) {
    if (parent.leaf()) {
      continue;
    }
    total = (total + alignment - 1) / alignment * alignment;
    for (std::uint32_t c = 0; c < parent.count; ++c) {
      offset[parent.first + c] = total;
      total += record_bytes;
    }
  }
  return offset;
}

}  // namespace

Fp32Layout encode_fp32(const WideBvh& bvh, std::uint32_t record_bytes, std::uint32_t alignment,
                       const std::string& what) {
  if (record_bytes < kFp32RecordLeast) {
    throw UserError("an FP32 node needs 33 bytes, not " + std::to_string(record_bytes));
  }
  Fp32Layout layout;
  if (bvh.empty() || bvh.records[0].leaf()) {
    return layout;
  }
  check_boxes(bvh, what);
  std::uint64_t total = 0;
  layout.offset = place(bvh, record_bytes, alignment, total);
  if (total > std::numeric_limits<std::uint32_t>::max()) {
    throw UserError(what + ": its nodes exceed the 4 GiB that 4-byte addresses reach");
  }
  ByteWriter out(layout.bytes, total);
  for (std::size_t i = 0; i < bvh.records.size(); ++i) {
    const BvhRecord& r = bvh.records[i];
    const std::uint64_t start = r.leaf() ? r.first : layout.offset[r.first];
    const std::uint64_t end = r.leaf() ? start + r.count : start + r.count * record_bytes;
    out.pad_to(layout.offset[i]);
    out.box(r.box);
    out.u32(static_cast<std::uint32_t>(start));
    out.u32(static_cast<std::uint32_t>(end));
    out.u8(r.leaf() ? 0xff : 0);
    out.pad_to(layout.offset[i] + record_bytes);
  }
  out.finish();
  return layout;
}

Fp32Record decode_fp32(std::span<const std::byte> bytes, std::uint64_t offset) {
  ByteReader in(bytes, offset);
  Fp32Record r;
  r.box = in.box();
  r.start = in.u32();
  r.end = in.u32();
  r.leaf = in.u8() == 0xff;
  return r;
}

}  // namespace a2rt::bvh
