#include "import_scene.h"

namespace a2rt::import {

void SceneTimeline::add_blas(const capture::AsBlock& block, Blas blas) {
  blas_at_[block.address] = blas_.size();
  tlas_at_.erase(block.address);
  blas_.push_back({std::move(blas), kNone});
  ++epoch_;
}

void SceneTimeline::add_tlas(const capture::AsBlock& block, RawTlas tlas) {
  tlas_at_[block.address] = tlas_.size();
  blas_at_.erase(block.address);
  tlas_by_id_[block.id] = tlas_.size();
  tlas_.push_back({std::move(tlas), kNone, {}, 0});
}

bool SceneTimeline::copy(const capture::AsCopyBlock& block) {
  const auto blas = blas_at_.find(block.source_address);
  if (blas != blas_at_.end()) {
    blas_at_[block.destination_address] = blas->second;
    tlas_at_.erase(block.destination_address);
    ++epoch_;
    return true;
  }
  const auto tlas = tlas_at_.find(block.source_address);
  if (tlas != tlas_at_.end()) {
    const std::size_t source = tlas->second;
    tlas_at_[block.destination_address] = source;
    blas_at_.erase(block.destination_address);
    tlas_by_id_[block.destination_id] = source;
    return true;
  }
  return false;
}

void SceneTimeline::destroy(std::uint64_t address) { tlas_at_.erase(address); }

std::uint32_t SceneTimeline::blas_index(std::uint64_t address) {
  const auto found = blas_at_.find(address);
  if (address == 0 || found == blas_at_.end()) {
    return kNone;
  }
  BuiltBlas& built = blas_[found->second];
  if (built.index == kNone) {
    built.index = static_cast<std::uint32_t>(workload_.blas.size());
    workload_.blas.push_back(std::move(built.blas));
  }
  return built.index;
}

std::uint32_t SceneTimeline::resolve(std::uint64_t id) {
  std::size_t number = 0;
  if (id == 0) {
    if (tlas_at_.size() != 1) {
      return kNone;
    }
    number = tlas_at_.begin()->second;
  } else {
    const auto found = tlas_by_id_.find(id);
    if (found == tlas_by_id_.end()) {
      return kNone;
    }
    number = found->second;
  }
  BuiltTlas& built = tlas_[number];
  if (built.index != kNone && built.epoch == epoch_) {
    return built.index;
  }
  std::vector<std::uint32_t> blas_of;
  for (const RawInstance& raw : built.raw.instances) {
    blas_of.push_back(blas_index(raw.blas_address));
  }
  if (built.index == kNone || blas_of != built.blas_of) {
    Tlas tlas;
    tlas.driver_nodes = built.raw.driver_nodes;
    for (std::size_t i = 0; i < blas_of.size(); ++i) {
      tlas.instances.push_back(built.raw.instances[i].instance);
      tlas.instances.back().blas = blas_of[i];
    }
    built.index = static_cast<std::uint32_t>(workload_.tlas.size());
    built.blas_of = std::move(blas_of);
    workload_.tlas.push_back(std::move(tlas));
  }
  built.epoch = epoch_;
  return built.index;
}

}  // namespace a2rt::import
