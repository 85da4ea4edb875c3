#include "state/shaders.h"

#include <algorithm>
#include <cstring>

namespace a2rt::layer {
namespace {

constexpr std::uint32_t kMostShaders = 1 << 16;  // records have 16 bits for the index

// SPIR-V execution model of a Vulkan stage.
std::uint32_t execution_model(VkShaderStageFlagBits stage) {
  switch (stage) {
    case VK_SHADER_STAGE_VERTEX_BIT:
      return 0;
    case VK_SHADER_STAGE_TESSELLATION_CONTROL_BIT:
      return 1;
    case VK_SHADER_STAGE_TESSELLATION_EVALUATION_BIT:
      return 2;
    case VK_SHADER_STAGE_GEOMETRY_BIT:
      return 3;
    case VK_SHADER_STAGE_FRAGMENT_BIT:
      return 4;
    case VK_SHADER_STAGE_COMPUTE_BIT:
      return 5;
    case VK_SHADER_STAGE_RAYGEN_BIT_KHR:
      return 5313;
    case VK_SHADER_STAGE_INTERSECTION_BIT_KHR:
      return 5314;
    case VK_SHADER_STAGE_ANY_HIT_BIT_KHR:
      return 5315;
    case VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR:
      return 5316;
    case VK_SHADER_STAGE_MISS_BIT_KHR:
      return 5317;
    case VK_SHADER_STAGE_CALLABLE_BIT_KHR:
      return 5318;
    case VK_SHADER_STAGE_TASK_BIT_EXT:
      return 5364;
    case VK_SHADER_STAGE_MESH_BIT_EXT:
      return 5365;
    default:
      return UINT32_MAX;
  }
}

}  // namespace

bool PipelineState::instrumented() const {
  return std::any_of(stages.begin(), stages.end(),
                     [](const StageState& stage) { return stage.shader != capture::kUnused; });
}

void Shaders::module_created(VkShaderModule module, std::shared_ptr<const ModuleState> state) {
  const std::lock_guard lock(mutex_);
  modules_[module] = std::move(state);
}

std::shared_ptr<const ModuleState> Shaders::module(VkShaderModule module) const {
  const std::lock_guard lock(mutex_);
  const auto found = modules_.find(module);
  return found == modules_.end() ? nullptr : found->second;
}

void Shaders::module_destroyed(VkShaderModule module) {
  const std::lock_guard lock(mutex_);
  modules_.erase(module);
}

std::optional<std::uint32_t> Shaders::reserve_indices(std::uint32_t count) {
  const std::lock_guard lock(mutex_);
  if (next_shader_ + count > kMostShaders) {
    return std::nullopt;
  }
  const std::uint32_t first = next_shader_;
  next_shader_ += count;
  return first;
}

void Shaders::pipeline_created(VkPipeline pipeline, std::shared_ptr<const PipelineState> state) {
  const std::lock_guard lock(mutex_);
  pipelines_[pipeline] = std::move(state);
}

std::shared_ptr<const PipelineState> Shaders::pipeline(VkPipeline pipeline) const {
  const std::lock_guard lock(mutex_);
  const auto found = pipelines_.find(pipeline);
  return found == pipelines_.end() ? nullptr : found->second;
}

std::shared_ptr<const PipelineState> Shaders::pipeline_destroyed(VkPipeline pipeline) {
  const std::lock_guard lock(mutex_);
  const auto found = pipelines_.find(pipeline);
  if (found == pipelines_.end()) {
    return nullptr;
  }
  auto state = found->second;
  pipelines_.erase(found);
  return state;
}

std::uint32_t Shaders::new_pipeline_index() {
  const std::lock_guard lock(mutex_);
  return next_pipeline_++;
}

const spirv::EntryPoint* find_entry_point(const spirv::Analysis& analysis,
                                          VkShaderStageFlagBits stage, const char* name) {
  const std::uint32_t model = execution_model(stage);
  for (const spirv::EntryPoint& entry : analysis.entry_points) {
    if (entry.execution_model == model && entry.name == name) {
      return &entry;
    }
  }
  return nullptr;
}

std::vector<spirv::Specialization> read_specialization(const VkSpecializationInfo* info) {
  std::vector<spirv::Specialization> out;
  for (std::uint32_t i = 0; info != nullptr && i < info->mapEntryCount; ++i) {
    const VkSpecializationMapEntry& entry = info->pMapEntries[i];
    std::uint32_t value = 0;
    std::memcpy(&value, static_cast<const std::byte*>(info->pData) + entry.offset,
                std::min(entry.size, sizeof(value)));
    out.push_back({entry.constantID, value});
  }
  return out;
}

std::uint64_t hash_words(std::span<const std::uint32_t> words) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::byte byte : std::as_bytes(words)) {
    hash = (hash ^ std::to_integer<std::uint64_t>(byte)) * 0x100000001b3u;
  }
  return hash;
}

}  // namespace a2rt::layer
