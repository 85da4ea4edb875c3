#include "a2rt/bvh/layout_fp32.h"

#include <string>

#include "a2rt/bvh/packing.h"

namespace a2rt::bvh {

std::vector<std::byte> encode_fp32(const WideBvh& bvh, std::uint32_t record_bytes) {
  if (record_bytes < kFp32RecordLeast) {
    throw UserError("an FP32 node needs 33 bytes, not " + std::to_string(record_bytes));
  }
  std::vector<std::byte> bytes;
  bytes.reserve(bvh.records.size() * record_bytes);
  ByteWriter out(bytes);
  for (const BvhRecord& r : bvh.records) {
    const std::size_t start = out.size();
    out.box(r.box);
    out.u32(r.first);
    out.u32(r.first + r.count);
    out.u8(r.leaf() ? 0xff : 0);
    out.pad_to(start + record_bytes);
  }
  return bytes;
}

Fp32Record decode_fp32(std::span<const std::byte> bytes, std::uint32_t record_bytes,
                       std::uint32_t record) {
  ByteReader in(bytes, std::size_t{record} * record_bytes);
  Fp32Record r;
  r.box = in.box();
  r.start = in.u32();
  r.end = in.u32();
  r.leaf = in.u8() == 0xff;
  return r;
}

}  // namespace a2rt::bvh
