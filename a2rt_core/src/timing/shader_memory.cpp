#include "a2rt/timing/shader_memory.h"

#include <algorithm>
#include <bit>

namespace a2rt::timing {
namespace {

// Areas far apart and far above the structures an RT unit lays out.
constexpr std::uint64_t kRecords = std::uint64_t{1} << 45;
constexpr std::uint64_t kMaterials = std::uint64_t{1} << 46;
constexpr std::uint64_t kStreams = std::uint64_t{1} << 47;
constexpr std::uint64_t kTexels = std::uint64_t{1} << 48;
constexpr std::uint64_t kPayloads = std::uint64_t{1} << 49;
constexpr std::uint64_t kRecordBytes = 128;
constexpr std::uint64_t kStreamBytes = 16;
constexpr std::uint64_t kPayloadWords = 64;  // per thread before the area is reused
constexpr std::uint64_t kWordBytes = 4;

std::uint64_t texel(std::uint32_t launch, std::uint32_t width) {
  const std::uint64_t x = launch % width, y = launch / width;
  const std::uint64_t tiles = (width + 7) / 8;
  return ((y / 4 * tiles + x / 8) * 32 + y % 4 * 8 + x % 8) * kWordBytes;
}

}  // namespace

ShaderAddresses::ShaderAddresses(const Workload& workload, const MachineConfig& config)
    : workload_(workload), model_(config.shader_memory), words_per_load_(config.sm.words_per_load) {
  std::uint64_t records = 0;
  for (const Blas& blas : workload.blas) {
    blas_first_.push_back(records);
    records += blas.primitive_count();
  }
  for (const Shader& shader : workload.shaders) {
    const auto stage = static_cast<capture::Stage>(shader.stage);
    works_on_hit_.push_back(stage == capture::Stage::kClosestHit ||
                            stage == capture::Stage::kAnyHit ||
                            stage == capture::Stage::kIntersection);
  }
}

std::uint64_t ShaderAddresses::record_of(std::uint32_t ray, std::uint32_t launch,
                                         bool& by_hit) const {
  by_hit = false;
  if (model_ == ShaderMemory::kStreaming || ray == kNone || ray >= workload_.driver_hits.size()) {
    return launch;
  }
  const Hit& hit = workload_.driver_hits[ray];
  if (hit.state != HitState::kHit && hit.state != HitState::kHitInferred) {
    return launch;
  }
  const std::uint32_t tlas = workload_.rays[ray].tlas;
  if (tlas >= workload_.tlas.size() || hit.instance >= workload_.tlas[tlas].instances.size()) {
    return launch;
  }
  const std::uint32_t blas = workload_.tlas[tlas].instances[hit.instance].blas;
  if (blas >= blas_first_.size() || hit.geometry >= workload_.blas[blas].geometries.size()) {
    return launch;
  }
  by_hit = true;
  return blas_first_[blas] + workload_.blas[blas].geometries[hit.geometry].first + hit.primitive;
}

void ShaderAddresses::sectors(ShaderAccess access, std::uint32_t ordinal, const SegmentWork& work,
                              const WarpProgram& warp, std::uint32_t width,
                              std::uint32_t thread_block, std::vector<Address>& out) const {
  out.clear();
  const std::uint64_t bytes = words_per_load_ * kWordBytes;
  const std::uint64_t offset = ordinal * bytes;
  const bool hit_shader = work.shader < works_on_hit_.size() && works_on_hit_[work.shader];
  bool sorted = true;
  const auto add = [&](std::uint64_t address, std::uint64_t length) {
    for (std::uint64_t s = address / kSectorBytes; s <= (address + length - 1) / kSectorBytes;
         ++s) {
      // Neighbouring lanes mostly share a sector.
      const Address sector{s * kSectorBytes};
      if (out.empty() || out.back() != sector) {
        sorted = sorted && (out.empty() || out.back() < sector);
        out.push_back(sector);
      }
    }
  };
  if (access == ShaderAccess::kPayload) {
    for (std::uint64_t w = 0; w < words_per_load_; ++w) {
      const std::uint64_t word = (ordinal * words_per_load_ + w) % kPayloadWords;
      for (std::uint32_t rest = work.lanes; rest != 0; rest &= rest - 1) {
        const auto l = static_cast<std::uint64_t>(std::countr_zero(rest));
        add(kPayloads + ((thread_block * kPayloadWords + word) * kLanes + l) * kWordBytes,
            kWordBytes);
      }
    }
  }
  for (std::uint32_t l = 0; l < kLanes && access != ShaderAccess::kPayload; ++l) {
    if ((work.lanes >> l & 1) == 0) {
      continue;
    }
    const std::uint32_t launch = warp.launch(l);
    const std::uint64_t stream = kStreams + (std::uint64_t{ordinal} << 32) + launch * kStreamBytes;
    switch (access) {
      case ShaderAccess::kBufferLoad: {
        bool by_hit = false;
        const std::uint64_t record =
            hit_shader ? record_of(warp.last_ray(l), launch, by_hit) : launch;
        if (!by_hit) {
          add(stream, bytes);
        } else if (offset + bytes <= kRecordBytes) {
          add(kRecords + record * kRecordBytes + offset, bytes);
        } else {
          add(kMaterials + offset, bytes);
        }
        break;
      }
      case ShaderAccess::kBufferStore:
        add(stream, kStreamBytes);
        break;
      case ShaderAccess::kTexture:
        add(kTexels + (std::uint64_t{ordinal} << 28) + texel(launch, width), kWordBytes);
        break;
      case ShaderAccess::kPayload:
        break;
    }
  }
  if (!sorted) {
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
  }
}

}  // namespace a2rt::timing
