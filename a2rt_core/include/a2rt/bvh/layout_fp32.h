// The baseline's records: one FP32 box each, 56 bytes by default (A2RT paper, section V.C.2).
//
// The paper gives the size only. Packed here: box 24, start and end of the child range 4 + 4, id
// byte 1 (0xff leaf, 0 inner), zeros up to the record size. 33 is what the content needs; the size
// is a parameter so that a reader can see how much of a saving is the baseline's padding.
// Start and end are record numbers (inner) or leaf-order primitive slots (leaf).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "a2rt/bvh/wide_bvh.h"

namespace a2rt::bvh {

inline constexpr std::uint32_t kFp32RecordLeast = 33;

struct Fp32Record {
  Box box;
  std::uint32_t start = 0, end = 0;
  bool leaf = false;
};

// Record r at byte r * record_bytes. Throws UserError for record_bytes < 33.
std::vector<std::byte> encode_fp32(const WideBvh& bvh, std::uint32_t record_bytes);
Fp32Record decode_fp32(std::span<const std::byte> bytes, std::uint32_t record_bytes,
                       std::uint32_t record);

}  // namespace a2rt::bvh
