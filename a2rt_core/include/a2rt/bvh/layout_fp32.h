// The baseline's records: one FP32 box each, 56 bytes by default (A2RT paper, section V.C.2).
//
// The paper gives the size only. Packed here: box 24, start and end of the child range 4 + 4, id
// byte 1 (0xff leaf, 0 inner), zeros up to the record size. 33 is what the content needs; the size
// is a parameter so that a reader can see how much of a saving is the baseline's padding.
// Start and end are byte offsets in the structure's node region (inner) or leaf-order primitive
// slots (leaf).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "a2rt/bvh/wide_bvh.h"

namespace a2rt::bvh {

inline constexpr std::uint32_t kFp32RecordLeast = 33;

struct Fp32Record {
  Box box;
  std::uint32_t start = 0, end = 0;
  bool leaf = false;
};

struct Fp32Layout {
  std::vector<std::byte> bytes;
  std::vector<std::uint64_t> offset;  // per record
};

// Records breadth first, the root at 0; every sibling range starts at a multiple of `alignment`. A
// tree that is one leaf has no records. Throws UserError for record_bytes < 33 or a tree beyond the
// 4 GiB that a 4-byte offset reaches.
Fp32Layout encode_fp32(const WideBvh& bvh, std::uint32_t record_bytes, std::uint32_t alignment,
                       const std::string& what);
Fp32Record decode_fp32(std::span<const std::byte> bytes, std::uint64_t offset);

}  // namespace a2rt::bvh
