#include "a2rt/timing/shader_memory.h"

#include <algorithm>

namespace a2rt::timing {

ShaderAddresses::ShaderAddresses(const Workload& workload, const MachineConfig& config)
    : workload_(workload), model_(config.shader_memory), words_per_load_(config.sm.words_per_load) {
  std::uint64_t records = 0;
  for (const Blas& blas : workload.blas) {
    blas_first_.push_back(static_cast<std::uint32_t>(records));
    records += blas.primitive_count();
  }
  A2RT_CHECK(records >> 32 == 0, "the records of a workload are counted in 32 bits");
  for (const Shader& shader : workload.shaders) {
    const auto stage = static_cast<capture::Stage>(shader.stage);
    works_on_hit_.push_back(stage == capture::Stage::kClosestHit ||
                            stage == capture::Stage::kAnyHit ||
                            stage == capture::Stage::kIntersection);
  }
}

bool ShaderAddresses::record_of(std::uint32_t ray, std::uint32_t& record) const {
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
  const Geometry& geometry = workload_.blas[blas].geometries[hit.geometry];
  if (hit.primitive >= geometry.count) {
    return false;
  }
  record = static_cast<std::uint32_t>(blas_first_[blas] + geometry.first + hit.primitive);
  return true;
}

void ShaderAddresses::find_records(std::uint32_t shader, const WarpProgram& warp,
                                   LaneAddresses& lanes) const {
  lanes.by_hit = lanes.records = 0;
  if (model_ == ShaderMemory::kStreaming || shader >= works_on_hit_.size() ||
      !works_on_hit_[shader]) {
    return;
  }
  for_each_bit(lanes.lanes, [&](std::uint32_t l) {
    if (warp.last_ray(l) < workload_.driver_hits.size()) {
      __builtin_prefetch(&workload_.driver_hits[warp.last_ray(l)]);
      __builtin_prefetch(&workload_.rays[warp.last_ray(l)].tlas);
    }
  });
  for_each_bit(lanes.lanes, [&](std::uint32_t l) {
    if (record_of(warp.last_ray(l), lanes.record[lanes.records])) {
      lanes.by_hit |= 1u << l;
      ++lanes.records;
    }
  });
  const auto begin = lanes.record.begin(), end = begin + lanes.records;
  std::sort(begin, end);
  lanes.records = static_cast<std::uint32_t>(std::unique(begin, end) - begin);
}

}  // namespace a2rt::timing
