// Shader modules and pipelines: which instrumented shaders a pipeline runs and where they trace.
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "a2rt/capture/manifest.h"
#include "spirv/instrument.h"

namespace a2rt::layer {

// A module that traces rays, as the program gave it.
struct ModuleState {
  std::vector<std::uint32_t> words;
  spirv::Analysis analysis;  // with the shader indices of the records
};

struct StageState {
  std::uint32_t shader = capture::kUnused;
  std::uint32_t effects = 0;  // capture::ShaderEffect bits
  std::vector<spirv::TraceSite> sites;
};

struct PipelineState {
  enum class Kind : std::uint32_t { kRayTracing = 0, kCompute = 1, kGraphics = 2 };
  std::uint32_t index = 0;  // PipelineBlock::pipeline
  Kind kind = Kind::kRayTracing;
  std::uint32_t max_recursion = 0;
  std::array<std::uint32_t, 3> local_size = {1, 1, 1};
  std::vector<StageState> stages;
  std::vector<capture::GroupBlock> groups;
  bool any_hit_may_depend_on_order = false;
  // Modules the layer made for stages with inline code; they live as long as the pipeline.
  std::vector<VkShaderModule> owned_modules;

  bool instrumented() const;
};

class Shaders {
 public:
  void module_created(VkShaderModule module, std::shared_ptr<const ModuleState> state);
  std::shared_ptr<const ModuleState> module(VkShaderModule module) const;
  void module_destroyed(VkShaderModule module);

  // Reserves `count` shader indices for records; nothing if the 16 bits are used up.
  std::optional<std::uint32_t> reserve_indices(std::uint32_t count);

  void pipeline_created(VkPipeline pipeline, std::shared_ptr<const PipelineState> state);
  std::shared_ptr<const PipelineState> pipeline(VkPipeline pipeline) const;
  // The state removed, for its owned modules.
  std::shared_ptr<const PipelineState> pipeline_destroyed(VkPipeline pipeline);
  std::uint32_t new_pipeline_index();

 private:
  mutable std::mutex mutex_;
  std::unordered_map<VkShaderModule, std::shared_ptr<const ModuleState>> modules_;
  std::unordered_map<VkPipeline, std::shared_ptr<const PipelineState>> pipelines_;
  std::uint32_t next_shader_ = 0;
  std::uint32_t next_pipeline_ = 0;
};

// The entry point of a stage; null if the module has none of that name and stage.
const spirv::EntryPoint* find_entry_point(const spirv::Analysis& analysis,
                                          VkShaderStageFlagBits stage, const char* name);

std::vector<spirv::Specialization> read_specialization(const VkSpecializationInfo* info);

// FNV-1a, 64 bits, over the bytes of the words.
std::uint64_t hash_words(std::span<const std::uint32_t> words);

}  // namespace a2rt::layer
