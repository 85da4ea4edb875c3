// Addresses for the shaders' own loads and stores, which the capture counts but does not name.
//
// Default model, `primitive`: a hit shader reads a 128-byte record of its ray's primitive (three
// vertices of 36 bytes and an index triple fill one in the LumiBench shaders), so lanes and warps
// that hit the same geometry share sectors as they would with real buffers; what it reads beyond
// that is a material shared by all. Ray generation and miss shaders stream by launch id. Texels lie
// in 8x4 tiles by launch id. Payload and attributes are thread-private words, interleaved by lane
// as GPUs lay out local memory. `streaming`: every buffer load streams by launch id (no reuse).
// `ideal`: loads take the L1's latency and cause no traffic. Uniform loads hit a constant cache.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "a2rt/timing/machine_config.h"
#include "a2rt/timing/program.h"
#include "a2rt/workload/workload.h"

namespace a2rt::timing {

enum class ShaderAccess : std::uint8_t { kBufferLoad, kBufferStore, kTexture, kPayload };

// Which record a lane's buffer loads go to in one segment; lanes without one stream by launch id.
struct LaneRecords {
  std::uint32_t by_hit = 0;  // bit per lane
  std::array<std::uint64_t, kLanes> record{};
};

class ShaderAddresses {
 public:
  ShaderAddresses(const Workload& workload, const MachineConfig& config);

  void find_records(const SegmentWork& work, const WarpProgram& warp, LaneRecords& out) const;

  // Sectors touched by access number `ordinal` of its kind in the segment, each once, ascending.
  void sectors(ShaderAccess access, std::uint32_t ordinal, const SegmentWork& work,
               const WarpProgram& warp, const LaneRecords& records, std::uint32_t width,
               std::uint32_t thread_block, std::vector<Address>& out) const;

 private:
  bool record_of(std::uint32_t ray, std::uint64_t& record) const;

  const Workload& workload_;
  ShaderMemory model_;
  std::uint32_t words_per_load_;
  std::vector<std::uint64_t> blas_first_;  // record number of each BLAS's first primitive
  std::vector<bool> works_on_hit_;         // by shader
};

}  // namespace a2rt::timing
