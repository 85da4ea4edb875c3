// Shader modules and pipelines: instrumented on the way to the driver.
#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "layer/device.h"
#include "layer/entry_points.h"

namespace a2rt::layer::entry {
namespace {

std::uint32_t effect_flags(const spirv::EntryPoint& entry) {
  using namespace capture;
  return (entry.uses_ray_query ? kUsesRayQuery : 0u) |
         (entry.executes_callable ? kExecutesCallable : 0u) |
         (entry.reports_intersection ? kReportsIntersection : 0u) |
         (entry.ignores_intersection ? kIgnoresIntersection : 0u) |
         (entry.terminates_ray ? kTerminatesRay : 0u) | (entry.writes_state ? kWritesState : 0u);
}

const VkShaderModuleCreateInfo* inline_module(const VkPipelineShaderStageCreateInfo& stage) {
  for (auto* item = static_cast<const VkBaseInStructure*>(stage.pNext); item != nullptr;
       item = item->pNext) {
    if (item->sType == VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO) {
      return reinterpret_cast<const VkShaderModuleCreateInfo*>(item);
    }
  }
  return nullptr;
}

std::span<const std::uint32_t> words_of(const VkShaderModuleCreateInfo& info) {
  return {info.pCode, info.codeSize / sizeof(std::uint32_t)};
}

VkResult create_module(Device& device, const VkShaderModuleCreateInfo& info,
                       const VkAllocationCallbacks* allocator, VkShaderModule* module) {
  const Device::Module changed = device.instrument(words_of(info));
  VkShaderModuleCreateInfo copy = info;
  if (changed.state != nullptr) {
    copy.pCode = changed.words.data();
    copy.codeSize = changed.words.size() * sizeof(std::uint32_t);
  }
  const VkResult result =
      device.table().CreateShaderModule(device.handle(), &copy, allocator, module);
  if (result == VK_SUCCESS && changed.state != nullptr) {
    device.shaders().module_created(*module, changed.state);
  }
  return result;
}

bool is_dynamic(const VkGraphicsPipelineCreateInfo& info, VkDynamicState state) {
  const VkPipelineDynamicStateCreateInfo* const dynamic = info.pDynamicState;
  return dynamic != nullptr &&
         std::find(dynamic->pDynamicStates, dynamic->pDynamicStates + dynamic->dynamicStateCount,
                   state) != dynamic->pDynamicStates + dynamic->dynamicStateCount;
}

bool is_part(const VkGraphicsPipelineCreateInfo& info) {
  for (auto* item = static_cast<const VkBaseInStructure*>(info.pNext); item != nullptr;
       item = item->pNext) {
    if (item->sType == VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_LIBRARY_CREATE_INFO_EXT ||
        item->sType == VK_STRUCTURE_TYPE_PIPELINE_LIBRARY_CREATE_INFO_KHR) {
      return true;
    }
  }
  return false;
}

// Whether a pipeline turns alpha into coverage, or leaves that to another part or a command. Then
// fragment tests before the shader would show in the picture.
bool may_cover(const VkGraphicsPipelineCreateInfo& info) {
  // Where no fragments come from, the state may be left undefined.
  const bool has_state = !is_part(info) && info.pRasterizationState != nullptr &&
                         info.pRasterizationState->rasterizerDiscardEnable == VK_FALSE &&
                         info.pMultisampleState != nullptr;
  return !has_state || info.pMultisampleState->alphaToCoverageEnable == VK_TRUE ||
         is_dynamic(info, VK_DYNAMIC_STATE_ALPHA_TO_COVERAGE_ENABLE_EXT);
}
bool may_cover(const VkRayTracingPipelineCreateInfoKHR&) { return false; }
bool may_cover(const VkComputePipelineCreateInfo&) { return false; }

// The stages of one pipeline: inline code replaced by instrumented modules, effects noted.
class Stages {
 public:
  Stages(Device& device, std::span<const VkPipelineShaderStageCreateInfo> stages, bool may_cover)
      : device_(device), stages_(stages.begin(), stages.end()), may_cover_(may_cover) {
    for (VkPipelineShaderStageCreateInfo& stage : stages_) {
      visit(stage);
    }
  }
  ~Stages() {
    for (const VkShaderModule module : owned_) {
      destroy(device_, module);
    }
  }
  Stages(Stages&& other) noexcept
      : device_(other.device_),
        stages_(std::move(other.stages_)),
        may_cover_(other.may_cover_),
        states_(std::move(other.states_)),
        owned_(std::exchange(other.owned_, {})),
        traces_(other.traces_),
        order_(other.order_),
        local_size_(other.local_size_) {}
  Stages& operator=(Stages&&) = delete;

  static void destroy(Device& device, VkShaderModule module) {
    device.shaders().module_destroyed(module);
    device.table().DestroyShaderModule(device.handle(), module, nullptr);
  }

  const VkPipelineShaderStageCreateInfo* data() const { return stages_.data(); }
  bool traces() const { return traces_; }

  // Hands everything over to the pipeline's state.
  void move_into(PipelineState& state) {
    state.stages = std::move(states_);
    state.owned_modules = std::exchange(owned_, {});
    state.any_hit_may_depend_on_order = order_;
    state.local_size = local_size_;
  }

 private:
  void visit(VkPipelineShaderStageCreateInfo& stage) {
    if (const auto* code = inline_module(stage);
        stage.module == VK_NULL_HANDLE && code != nullptr) {
      VkShaderModuleCreateInfo info = *code;
      info.pNext = nullptr;
      VkShaderModule module = VK_NULL_HANDLE;
      if (create_module(device_, info, nullptr, &module) == VK_SUCCESS) {
        owned_.push_back(module);
        // Code that traces nothing stays inline, as the program gave it.
        if (device_.shaders().module(module) != nullptr) {
          stage.module = module;
        }
      }
    }
    states_.push_back(note(stage));
  }

  // Gives the stage `words` as they are, in a module that lives as long as the pipeline.
  void replace_module(VkPipelineShaderStageCreateInfo& stage,
                      std::span<const std::uint32_t> words) {
    VkShaderModuleCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
    info.codeSize = words.size_bytes();
    info.pCode = words.data();
    VkShaderModule module = VK_NULL_HANDLE;
    if (device_.table().CreateShaderModule(device_.handle(), &info, nullptr, &module) ==
        VK_SUCCESS) {
      owned_.push_back(module);
      stage.module = module;
    }
  }

  // A shader without a known workgroup size has no launch ids, so it runs as the program gave it.
  void leave_out(VkPipelineShaderStageCreateInfo& stage, const ModuleState& module) {
    device_.refuse_once("the workgroup size of compute shader '" + std::string(stage.pName) +
                        "' (shader hash " + std::to_string(hash_words(module.words)) +
                        ") cannot be told from its specialization constants: its rays are not "
                        "captured");
    replace_module(stage, module.words);
  }

  void settle_tests(VkPipelineShaderStageCreateInfo& stage, const ModuleState& module,
                    spirv::FragmentTests tests) {
    using spirv::FragmentTests;
    const bool late = tests == FragmentTests::kMadeEarly && may_cover_;
    if (late) {
      replace_module(stage, device_.instrument_late(module));
    }
    if (late || tests == FragmentTests::kMadeLate) {
      device_.refuse_once(
          "a fragment shader that traces also discards, writes a sample mask or may have its alpha "
          "turned into coverage: where depth or stencil tests hide its fragments, the capture "
          "holds "
          "rays that the driver alone would have skipped");
    }
  }

  StageState note(VkPipelineShaderStageCreateInfo& stage) {
    StageState state;
    const auto module = device_.shaders().module(stage.module);
    const spirv::EntryPoint* entry =
        module ? find_entry_point(module->analysis, stage.stage, stage.pName) : nullptr;
    if (entry == nullptr || !entry->instrumented) {
      return state;
    }
    // Constants of this pipeline decide flags and sizes that the module alone leaves open.
    const auto constants = read_specialization(stage.pSpecializationInfo);
    const spirv::Analysis special = spirv::analyse(module->words, constants);
    if (const auto* sized = find_entry_point(special, stage.stage, stage.pName);
        sized != nullptr && stage.stage == VK_SHADER_STAGE_COMPUTE_BIT) {
      local_size_ = sized->local_size;
      if (std::ranges::find(local_size_, 0u) != local_size_.end()) {
        leave_out(stage, *module);
        return state;
      }
    }
    settle_tests(stage, *module, entry->fragment_tests);
    traces_ = true;
    state.shader = entry->shader;
    state.effects = effect_flags(*entry);
    order_ = order_ || (stage.stage == VK_SHADER_STAGE_ANY_HIT_BIT_KHR &&
                        (entry->writes_state || entry->terminates_ray));
    for (const std::uint32_t site : entry->sites) {
      if (site < special.sites.size() && module->analysis.sites[site].instrumented) {
        state.sites.push_back(special.sites[site]);
      }
    }
    return state;
  }

  Device& device_;
  std::vector<VkPipelineShaderStageCreateInfo> stages_;
  bool may_cover_;
  std::vector<StageState> states_;
  std::vector<VkShaderModule> owned_;
  bool traces_ = false;
  bool order_ = false;
  std::array<std::uint32_t, 3> local_size_ = {1, 1, 1};
};

std::span<const VkPipelineShaderStageCreateInfo> stages_of(
    const VkRayTracingPipelineCreateInfoKHR& info) {
  return {info.pStages, info.stageCount};
}
std::span<const VkPipelineShaderStageCreateInfo> stages_of(
    const VkGraphicsPipelineCreateInfo& info) {
  // A library without shaders may leave the pointer undefined.
  return {info.pStages, info.pStages == nullptr ? 0 : info.stageCount};
}
std::span<const VkPipelineShaderStageCreateInfo> stages_of(
    const VkComputePipelineCreateInfo& info) {
  return {&info.stage, 1};
}

void set_stages(VkRayTracingPipelineCreateInfoKHR& info, const Stages& stages) {
  info.pStages = stages.data();
}
void set_stages(VkGraphicsPipelineCreateInfo& info, const Stages& stages) {
  info.pStages = info.pStages == nullptr ? nullptr : stages.data();
}
void set_stages(VkComputePipelineCreateInfo& info, const Stages& stages) {
  info.stage = *stages.data();
}

const VkPipelineLibraryCreateInfoKHR* libraries_of(const VkRayTracingPipelineCreateInfoKHR& info) {
  return info.pLibraryInfo;
}
const VkPipelineLibraryCreateInfoKHR* libraries_of(const VkGraphicsPipelineCreateInfo& info) {
  for (auto* item = static_cast<const VkBaseInStructure*>(info.pNext); item != nullptr;
       item = item->pNext) {
    if (item->sType == VK_STRUCTURE_TYPE_PIPELINE_LIBRARY_CREATE_INFO_KHR) {
      return reinterpret_cast<const VkPipelineLibraryCreateInfoKHR*>(item);
    }
  }
  return nullptr;
}
const VkPipelineLibraryCreateInfoKHR* libraries_of(const VkComputePipelineCreateInfo&) {
  return nullptr;
}

void add_groups(PipelineState& state, const VkRayTracingPipelineCreateInfoKHR& info) {
  state.max_recursion = info.maxPipelineRayRecursionDepth;
  for (std::uint32_t i = 0; i < info.groupCount; ++i) {
    const VkRayTracingShaderGroupCreateInfoKHR& group = info.pGroups[i];
    state.groups.push_back({static_cast<std::uint32_t>(group.type), group.generalShader,
                            group.closestHitShader, group.anyHitShader, group.intersectionShader});
  }
}
void add_groups(PipelineState&, const VkGraphicsPipelineCreateInfo&) {}
void add_groups(PipelineState&, const VkComputePipelineCreateInfo&) {}

// Stages and groups of libraries follow the pipeline's own; stage numbers move accordingly.
void add_library(PipelineState& state, const PipelineState& library) {
  const auto offset = static_cast<std::uint32_t>(state.stages.size());
  state.stages.insert(state.stages.end(), library.stages.begin(), library.stages.end());
  const auto moved = [offset](std::uint32_t stage) {
    return stage == capture::kUnused ? stage : stage + offset;
  };
  for (const capture::GroupBlock& group : library.groups) {
    state.groups.push_back({group.type, moved(group.general), moved(group.closest_hit),
                            moved(group.any_hit), moved(group.intersection)});
  }
  state.any_hit_may_depend_on_order =
      state.any_hit_may_depend_on_order || library.any_hit_may_depend_on_order;
}

template <class Info>
void remember(Device& device, const Info& info, PipelineState::Kind kind, Stages& stages,
              VkPipeline pipeline) {
  PipelineState state;
  stages.move_into(state);
  state.kind = kind;
  add_groups(state, info);
  if (const auto* libraries = libraries_of(info)) {
    for (std::uint32_t i = 0; i < libraries->libraryCount; ++i) {
      if (const auto library = device.shaders().pipeline(libraries->pLibraries[i])) {
        add_library(state, *library);
      }
    }
  }
  if (kind != PipelineState::Kind::kRayTracing && !state.instrumented() &&
      state.owned_modules.empty()) {
    return;
  }
  if (state.instrumented()) {
    state.index = device.shaders().new_pipeline_index();
    device.announce(state);
  }
  device.shaders().pipeline_created(pipeline,
                                    std::make_shared<const PipelineState>(std::move(state)));
}

// Instruments the stages of all pipelines, has them made by `create`, remembers what came of it.
template <class Info, class Create>
VkResult create_pipelines(Device& device, PipelineState::Kind kind, std::span<const Info> infos,
                          VkPipeline* pipelines, const Create& create) {
  if (device.session() == nullptr) {
    return create(infos.data());
  }
  std::vector<Info> copies(infos.begin(), infos.end());
  std::vector<Stages> stages;
  stages.reserve(copies.size());
  for (Info& copy : copies) {
    stages.emplace_back(device, stages_of(copy), may_cover(copy));
    set_stages(copy, stages.back());
  }
  const VkResult result = create(copies.data());
  for (std::size_t i = 0; i < copies.size(); ++i) {
    if (pipelines[i] != VK_NULL_HANDLE && result >= 0) {
      remember(device, copies[i], kind, stages[i], pipelines[i]);
    }
  }
  return result;
}

}  // namespace

VkResult CreateShaderModule(VkDevice handle, const VkShaderModuleCreateInfo* info,
                            const VkAllocationCallbacks* allocator, VkShaderModule* module) {
  return create_module(device_of(handle), *info, allocator, module);
}

void DestroyShaderModule(VkDevice handle, VkShaderModule module,
                         const VkAllocationCallbacks* allocator) {
  Device& device = device_of(handle);
  device.shaders().module_destroyed(module);
  device.table().DestroyShaderModule(handle, module, allocator);
}

VkResult CreateRayTracingPipelinesKHR(VkDevice handle, VkDeferredOperationKHR operation,
                                      VkPipelineCache cache, std::uint32_t count,
                                      const VkRayTracingPipelineCreateInfoKHR* infos,
                                      const VkAllocationCallbacks* allocator,
                                      VkPipeline* pipelines) {
  Device& device = device_of(handle);
  // The stages handed down live until this call returns, so the work is not deferred.
  const VkResult result =
      create_pipelines(device, PipelineState::Kind::kRayTracing, std::span(infos, count), pipelines,
                       [&](const VkRayTracingPipelineCreateInfoKHR* copies) {
                         return device.table().CreateRayTracingPipelinesKHR(
                             handle, VK_NULL_HANDLE, cache, count, copies, allocator, pipelines);
                       });
  const bool deferred = operation != VK_NULL_HANDLE && result == VK_SUCCESS;
  return deferred ? VK_OPERATION_NOT_DEFERRED_KHR : result;
}

VkResult CreateComputePipelines(VkDevice handle, VkPipelineCache cache, std::uint32_t count,
                                const VkComputePipelineCreateInfo* infos,
                                const VkAllocationCallbacks* allocator, VkPipeline* pipelines) {
  Device& device = device_of(handle);
  return create_pipelines(device, PipelineState::Kind::kCompute, std::span(infos, count), pipelines,
                          [&](const VkComputePipelineCreateInfo* copies) {
                            return device.table().CreateComputePipelines(
                                handle, cache, count, copies, allocator, pipelines);
                          });
}

VkResult CreateGraphicsPipelines(VkDevice handle, VkPipelineCache cache, std::uint32_t count,
                                 const VkGraphicsPipelineCreateInfo* infos,
                                 const VkAllocationCallbacks* allocator, VkPipeline* pipelines) {
  Device& device = device_of(handle);
  return create_pipelines(device, PipelineState::Kind::kGraphics, std::span(infos, count),
                          pipelines, [&](const VkGraphicsPipelineCreateInfo* copies) {
                            return device.table().CreateGraphicsPipelines(
                                handle, cache, count, copies, allocator, pipelines);
                          });
}

void DestroyPipeline(VkDevice handle, VkPipeline pipeline, const VkAllocationCallbacks* allocator) {
  Device& device = device_of(handle);
  if (const auto state = device.shaders().pipeline_destroyed(pipeline)) {
    for (const VkShaderModule module : state->owned_modules) {
      Stages::destroy(device, module);
    }
  }
  device.table().DestroyPipeline(handle, pipeline, allocator);
}

}  // namespace a2rt::layer::entry
