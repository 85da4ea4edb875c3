// Addresses for the shaders' own loads and stores, which the capture counts but does not name.
//
// Default model, `primitive`: a hit shader reads a 128-byte record of its ray's primitive (three
// vertices of 36 bytes and an index triple fill one in the LumiBench shaders), so lanes and warps
// that hit the same geometry share sectors as they would with real buffers; what it reads beyond
// that is a material shared by all. Ray generation and miss shaders stream by launch id. Texels lie
// in 8x4 tiles by launch id. Payload and attributes are thread-private words, interleaved by lane
// as GPUs lay out local memory. `streaming`: every buffer load streams by launch id (no reuse).
// `ideal`: loads take the L1's latency and cause no traffic. Uniform loads hit a constant cache.
//
// Records, texel tiles and rows of payload words are all as large as a line and lie on one each.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "a2rt/timing/machine_config.h"
#include "a2rt/timing/memory_port.h"
#include "a2rt/timing/program.h"
#include "a2rt/workload/workload.h"

namespace a2rt::timing {

enum class ShaderAccess : std::uint8_t { kBufferLoad, kBufferStore, kTexture, kPayload };

// What decides where a warp's lanes load and store in one segment.
struct LaneAddresses {
  std::uint32_t lanes = 0;         // bit per lane
  std::uint32_t first_launch = 0;  // launch id of lane 0
  std::uint32_t width = 1;         // of the launch
  std::uint32_t thread_block = 0;  // place on the machine
  std::uint32_t by_hit = 0;        // lanes that load the record of a primitive; the others stream
  std::uint32_t records = 0;
  std::array<std::uint32_t, kLanes> record;  // those loaded, each once, ascending
};

class ShaderAddresses {
 public:
  ShaderAddresses(const Workload& workload, const MachineConfig& config);

  // Finds the records of lanes in shader `shader`.
  void find_records(std::uint32_t shader, const WarpProgram& warp, LaneAddresses& lanes) const;

  // Calls to(line, sectors) for each line that access number `ordinal` of its kind in the segment
  // touches, ascending.
  template <class To>
  void lines(ShaderAccess access, std::uint32_t ordinal, const LaneAddresses& lanes,
             const To& to) const {
    switch (access) {
      case ShaderAccess::kBufferLoad:
        return buffer_load(ordinal, lanes, to);
      case ShaderAccess::kBufferStore:
        return stream(ordinal, lanes, lanes.lanes, kStreamBytes, to);
      case ShaderAccess::kTexture:
        return texture(ordinal, lanes, to);
      case ShaderAccess::kPayload:
        return payload(ordinal, lanes, to);
    }
  }

 private:
  // Areas far apart and far above the structures an RT unit lays out.
  static constexpr std::uint64_t kRecords = std::uint64_t{1} << 45;
  static constexpr std::uint64_t kMaterials = std::uint64_t{1} << 46;
  static constexpr std::uint64_t kStreams = std::uint64_t{1} << 47;
  static constexpr std::uint64_t kTexels = std::uint64_t{1} << 48;
  static constexpr std::uint64_t kPayloads = std::uint64_t{1} << 49;
  static constexpr std::uint64_t kStreamBytes = 16;
  static constexpr std::uint64_t kPayloadWords = 64;  // per thread before the area is reused
  static constexpr std::uint64_t kWordBytes = 4;

  bool record_of(std::uint32_t ray, std::uint32_t& record) const;

  template <class To>
  void buffer_load(std::uint32_t ordinal, const LaneAddresses& lanes, const To& to) const {
    const std::uint64_t bytes = words_per_load_ * kWordBytes, offset = ordinal * bytes;
    if (lanes.by_hit != 0) {
      if (offset + bytes <= kLineBytes) {
        const auto sectors = static_cast<SectorMask>((2u << (offset + bytes - 1) / kSectorBytes) -
                                                     (1u << offset / kSectorBytes));
        for (std::uint32_t r = 0; r < lanes.records; ++r) {
          to(kRecords / kLineBytes + lanes.record[r], sectors);
        }
      } else {
        for_each_line(Address{kMaterials + offset}, bytes, to);
      }
    }
    if (lanes.by_hit != lanes.lanes) {
      stream(ordinal, lanes, lanes.lanes & ~lanes.by_hit, bytes, to);
    }
  }

  // The lanes' pieces may overlap, but each begins and ends behind the one before.
  template <class To>
  static void stream(std::uint32_t ordinal, const LaneAddresses& lanes, std::uint32_t mask,
                     std::uint64_t bytes, const To& to) {
    const std::uint64_t base =
        kStreams + (std::uint64_t{ordinal} << 32) + lanes.first_launch * kStreamBytes;
    std::uint64_t line = 0, next = 0;  // sector after the last found
    std::uint32_t sectors = 0;
    for_each_bit(mask, [&](std::uint32_t l) {
      const std::uint64_t begin = base + l * kStreamBytes;
      const std::uint64_t last = (begin + bytes - 1) / kSectorBytes;
      for (std::uint64_t s = std::max(next, begin / kSectorBytes); s <= last; ++s) {
        if (s / kSectorsPerLine != line && sectors != 0) {
          to(line, static_cast<SectorMask>(sectors));
          sectors = 0;
        }
        line = s / kSectorsPerLine;
        sectors |= 1u << s % kSectorsPerLine;
      }
      next = last + 1;
    });
    to(line, static_cast<SectorMask>(sectors));
  }

  // A row of a tile is a sector.
  template <class To>
  static void texture(std::uint32_t ordinal, const LaneAddresses& lanes, const To& to) {
    const std::uint64_t x = lanes.first_launch % lanes.width, y = lanes.first_launch / lanes.width;
    const std::uint64_t tiles = (lanes.width + 7) / 8;
    A2RT_CHECK(x + std::bit_width(lanes.lanes) <= lanes.width, "a warp lies in one row");
    std::uint64_t line =
        (kTexels + (std::uint64_t{ordinal} << 28)) / kLineBytes + y / 4 * tiles + x / 8;
    for (std::uint64_t texels = std::uint64_t{lanes.lanes} << x % 8; texels != 0; texels >>= 8) {
      if ((texels & 0xff) != 0) {
        to(line, static_cast<SectorMask>(1u << y % 4));
      }
      ++line;
    }
  }

  template <class To>
  void payload(std::uint32_t ordinal, const LaneAddresses& lanes, const To& to) const {
    // Bit 0 of each byte: any of the eight lanes of a sector.
    std::uint32_t any = lanes.lanes | lanes.lanes >> 4;
    any |= any >> 2;
    any = (any | any >> 1) & 0x01010101;
    const auto sectors = static_cast<SectorMask>(any * 0x01020408 >> 24);
    const std::uint64_t first = kPayloads / kLineBytes + lanes.thread_block * kPayloadWords;
    const std::uint64_t begin = std::uint64_t{ordinal} * words_per_load_ % kPayloadWords;
    const std::uint64_t end = begin + std::min<std::uint64_t>(words_per_load_, kPayloadWords);
    for (std::uint64_t word = kPayloadWords; word < end; ++word) {
      to(first + word - kPayloadWords, sectors);
    }
    for (std::uint64_t word = begin; word < std::min(end, kPayloadWords); ++word) {
      to(first + word, sectors);
    }
  }

  const Workload& workload_;
  ShaderMemory model_;
  std::uint32_t words_per_load_;
  std::vector<std::uint32_t> blas_first_;  // record number of each BLAS's first primitive
  std::vector<bool> works_on_hit_;         // by shader
};

}  // namespace a2rt::timing
