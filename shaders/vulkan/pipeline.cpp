#include "vulkan/pipeline.h"

#include <cstring>

#include "a2rt/base/error.h"

namespace a2rt::vulkan {
namespace {

VkRayTracingShaderGroupCreateInfoKHR general_group(std::uint32_t stage) {
  VkRayTracingShaderGroupCreateInfoKHR g{};
  g.sType = VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR;
  g.type = VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR;
  g.generalShader = stage;
  g.closestHitShader = g.anyHitShader = g.intersectionShader = VK_SHADER_UNUSED_KHR;
  return g;
}

VkRayTracingShaderGroupCreateInfoKHR hit_group(const HitGroup& hit) {
  VkRayTracingShaderGroupCreateInfoKHR g = general_group(VK_SHADER_UNUSED_KHR);
  g.type = hit.intersection ? VK_RAY_TRACING_SHADER_GROUP_TYPE_PROCEDURAL_HIT_GROUP_KHR
                            : VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR;
  g.closestHitShader = hit.closest_hit.value_or(VK_SHADER_UNUSED_KHR);
  g.anyHitShader = hit.any_hit.value_or(VK_SHADER_UNUSED_KHR);
  g.intersectionShader = hit.intersection.value_or(VK_SHADER_UNUSED_KHR);
  return g;
}

VkDeviceSize align(VkDeviceSize value, VkDeviceSize to) { return (value + to - 1) / to * to; }

// Shader modules that live while a pipeline is made.
class Modules {
 public:
  explicit Modules(VkDevice device) : device_(device) {}
  Modules(const Modules&) = delete;
  Modules& operator=(const Modules&) = delete;
  ~Modules() {
    for (VkShaderModule m : modules_) {
      vkDestroyShaderModule(device_, m, nullptr);
    }
  }
  VkShaderModule add(std::span<const std::uint32_t> words) {
    VkShaderModuleCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
    info.codeSize = words.size_bytes();
    info.pCode = words.data();
    VkShaderModule module = VK_NULL_HANDLE;
    check(vkCreateShaderModule(device_, &info, nullptr, &module), "vkCreateShaderModule");
    modules_.push_back(module);
    return module;
  }

 private:
  VkDevice device_;
  std::vector<VkShaderModule> modules_;
};

}  // namespace

Pipeline::Pipeline(const Context& context, const PipelineDescription& description)
    : context_(&context) {
  create_layout(description);
  create_pipeline(description);
  create_binding_table(description);
}

Pipeline::~Pipeline() {
  vkDestroyPipeline(context_->device(), pipeline_, nullptr);
  vkDestroyPipelineLayout(context_->device(), layout_, nullptr);
  vkDestroyDescriptorSetLayout(context_->device(), set_layout_, nullptr);
}

void Pipeline::create_layout(const PipelineDescription& description) {
  VkDescriptorSetLayoutCreateInfo set{};
  set.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  set.bindingCount = static_cast<std::uint32_t>(description.bindings.size());
  set.pBindings = description.bindings.data();
  check(vkCreateDescriptorSetLayout(context_->device(), &set, nullptr, &set_layout_),
        "vkCreateDescriptorSetLayout");
  VkPipelineLayoutCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  info.setLayoutCount = 1;
  info.pSetLayouts = &set_layout_;
  check(vkCreatePipelineLayout(context_->device(), &info, nullptr, &layout_),
        "vkCreatePipelineLayout");
}

void Pipeline::create_pipeline(const PipelineDescription& description) {
  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < description.constants.size(); ++i) {
    entries.push_back({i, i * 4, 4});
  }
  VkSpecializationInfo constants{};
  constants.mapEntryCount = static_cast<std::uint32_t>(entries.size());
  constants.pMapEntries = entries.data();
  constants.dataSize = description.constants.size() * 4;
  constants.pData = description.constants.data();

  Modules modules(context_->device());
  std::vector<VkPipelineShaderStageCreateInfo> stages;
  for (const ShaderCode& code : description.stages) {
    VkPipelineShaderStageCreateInfo stage{};
    stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    stage.stage = code.stage;
    stage.module = modules.add(code.words);
    stage.pName = "main";
    stage.pSpecializationInfo = &constants;
    stages.push_back(stage);
  }
  std::vector<VkRayTracingShaderGroupCreateInfoKHR> groups;
  groups.push_back(general_group(description.ray_generation));
  for (const std::uint32_t miss : description.misses) {
    groups.push_back(general_group(miss));
  }
  for (const HitGroup& hit : description.hit_groups) {
    groups.push_back(hit_group(hit));
  }
  VkRayTracingPipelineCreateInfoKHR info{};
  info.sType = VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR;
  info.stageCount = static_cast<std::uint32_t>(stages.size());
  info.pStages = stages.data();
  info.groupCount = static_cast<std::uint32_t>(groups.size());
  info.pGroups = groups.data();
  info.maxPipelineRayRecursionDepth = description.recursion;
  info.layout = layout_;
  if (description.recursion > context_->max_recursion()) {
    throw UserError("the workload needs ray recursion " + std::to_string(description.recursion) +
                    " but the device allows " + std::to_string(context_->max_recursion()));
  }
  check(context_->rt().create_pipelines(context_->device(), VK_NULL_HANDLE, VK_NULL_HANDLE, 1,
                                        &info, nullptr, &pipeline_),
        "vkCreateRayTracingPipelinesKHR");
}

void Pipeline::create_binding_table(const PipelineDescription& description) {
  const std::uint32_t size = context_->group_handle_size();
  const VkDeviceSize base = context_->group_base_alignment();
  const auto misses = static_cast<std::uint32_t>(description.misses.size());
  const auto hits = static_cast<std::uint32_t>(description.hit_groups.size());
  const std::uint32_t groups = 1 + misses + hits;
  std::vector<std::uint8_t> handles(std::size_t{groups} * size);
  check(context_->rt().group_handles(context_->device(), pipeline_, 0, groups, handles.size(),
                                     handles.data()),
        "vkGetRayTracingShaderGroupHandlesKHR");
  const VkDeviceSize miss_at = align(size, base);
  const VkDeviceSize hit_at = miss_at + align(VkDeviceSize{size} * misses, base);
  table_ = Buffer(*context_, hit_at + VkDeviceSize{size} * hits + base,
                  VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR);
  const VkDeviceSize start = align(table_.address(), base) - table_.address();
  auto* bytes = static_cast<std::uint8_t*>(table_.mapped()) + start;
  std::memcpy(bytes, handles.data(), size);
  std::memcpy(bytes + miss_at, handles.data() + size, std::size_t{size} * misses);
  std::memcpy(bytes + hit_at, handles.data() + std::size_t{size} * (1 + misses),
              std::size_t{size} * hits);
  const VkDeviceAddress address = table_.address() + start;
  generation_ = {address, size, size};
  miss_ = {address + miss_at, size, VkDeviceSize{size} * misses};
  hit_ = {address + hit_at, size, VkDeviceSize{size} * hits};
}

void Pipeline::trace(VkCommandBuffer commands, VkDescriptorSet set, std::uint32_t width,
                     std::uint32_t height) const {
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, pipeline_);
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, layout_, 0, 1, &set, 0,
                          nullptr);
  context_->rt().cmd_trace_rays(commands, &generation_, &miss_, &hit_, &callable_, width, height,
                                1);
}

}  // namespace a2rt::vulkan
