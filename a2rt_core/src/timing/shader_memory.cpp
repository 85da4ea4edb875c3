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
constexpr std::uint64_t kLanesPerSector = kSectorBytes / kWordBytes;  // of a payload word

std::uint64_t texel(std::uint32_t launch, std::uint32_t width) {
  const std::uint64_t x = launch % width, y = launch / width;
  const std::uint64_t tiles = (width + 7) / 8;
  return ((y / 4 * tiles + x / 8) * 32 + y % 4 * 8 + x % 8) * kWordBytes;
}

// Collects the sectors of a warp's lanes: neighbours mostly share one.
class SectorList {
 public:
  explicit SectorList(std::vector<Address>& out) : out_(out) { out_.clear(); }

  void add(std::uint64_t address, std::uint64_t bytes) {
    for (std::uint64_t s = address / kSectorBytes; s <= (address + bytes - 1) / kSectorBytes; ++s) {
      if (s != last_) {
        sorted_ = sorted_ && (out_.empty() || last_ < s);
        last_ = s;
        out_.push_back(Address{s * kSectorBytes});
      }
    }
  }
  void finish() {
    if (!sorted_) {
      std::sort(out_.begin(), out_.end());
      out_.erase(std::unique(out_.begin(), out_.end()), out_.end());
    }
  }

 private:
  std::vector<Address>& out_;
  std::uint64_t last_ = ~std::uint64_t{0};
  bool sorted_ = true;
};

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

bool ShaderAddresses::record_of(std::uint32_t ray, std::uint64_t& record) const {
  if (ray == kNone || ray >= workload_.driver_hits.size()) {
    return false;
  }
  const Hit& hit = workload_.driver_hits[ray];
  if (hit.state != HitState::kHit && hit.state != HitState::kHitInferred) {
    return false;
  }
  const std::uint32_t tlas = workload_.rays[ray].tlas;
  if (tlas >= workload_.tlas.size() || hit.instance >= workload_.tlas[tlas].instances.size()) {
    return false;
  }
  const std::uint32_t blas = workload_.tlas[tlas].instances[hit.instance].blas;
  if (blas >= blas_first_.size() || hit.geometry >= workload_.blas[blas].geometries.size()) {
    return false;
  }
  record = blas_first_[blas] + workload_.blas[blas].geometries[hit.geometry].first + hit.primitive;
  return true;
}

void ShaderAddresses::find_records(const SegmentWork& work, const WarpProgram& warp,
                                   LaneRecords& out) const {
  out.by_hit = 0;
  if (model_ == ShaderMemory::kStreaming || work.shader >= works_on_hit_.size() ||
      !works_on_hit_[work.shader]) {
    return;
  }
  for_each_bit(work.lanes, [&](std::uint32_t l) {
    if (warp.last_ray(l) < workload_.driver_hits.size()) {
      __builtin_prefetch(&workload_.driver_hits[warp.last_ray(l)]);
      __builtin_prefetch(&workload_.rays[warp.last_ray(l)].tlas);
    }
  });
  for_each_bit(work.lanes, [&](std::uint32_t l) {
    out.by_hit |= std::uint32_t{record_of(warp.last_ray(l), out.record[l])} << l;
  });
}

void ShaderAddresses::sectors(ShaderAccess access, std::uint32_t ordinal, const SegmentWork& work,
                              const WarpProgram& warp, const LaneRecords& records,
                              std::uint32_t width, std::uint32_t thread_block,
                              std::vector<Address>& out) const {
  SectorList list(out);
  const std::uint64_t bytes = words_per_load_ * kWordBytes;
  const std::uint64_t offset = ordinal * bytes;
  const std::uint64_t streams = kStreams + (std::uint64_t{ordinal} << 32);
  switch (access) {
    case ShaderAccess::kBufferLoad:
      for_each_bit(work.lanes, [&](std::uint32_t l) {
        if ((records.by_hit >> l & 1) == 0) {
          list.add(streams + warp.launch(l) * kStreamBytes, bytes);
        } else if (offset + bytes <= kRecordBytes) {
          list.add(kRecords + records.record[l] * kRecordBytes + offset, bytes);
        } else {
          list.add(kMaterials + offset, bytes);
        }
      });
      break;
    case ShaderAccess::kBufferStore:
      for_each_bit(work.lanes, [&](std::uint32_t l) {
        list.add(streams + warp.launch(l) * kStreamBytes, kStreamBytes);
      });
      break;
    case ShaderAccess::kTexture:
      for_each_bit(work.lanes, [&](std::uint32_t l) {
        list.add(kTexels + (std::uint64_t{ordinal} << 28) + texel(warp.launch(l), width),
                 kWordBytes);
      });
      break;
    case ShaderAccess::kPayload:
      for (std::uint64_t w = 0; w < words_per_load_; ++w) {
        const std::uint64_t word = (ordinal * words_per_load_ + w) % kPayloadWords;
        const std::uint64_t row =
            kPayloads + (thread_block * kPayloadWords + word) * kLanes * kWordBytes;
        for (std::uint64_t s = 0; s < kLanes * kWordBytes / kSectorBytes; ++s) {
          if ((work.lanes >> s * kLanesPerSector & ((1u << kLanesPerSector) - 1)) != 0) {
            list.add(row + s * kSectorBytes, kWordBytes);
          }
        }
      }
      break;
  }
  list.finish();
}

}  // namespace a2rt::timing
