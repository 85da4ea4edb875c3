// A ray-tracing pipeline with its descriptor set layout and shader binding table.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vulkan/buffer.h"

namespace a2rt::vulkan {

struct ShaderCode {
  VkShaderStageFlagBits stage = VK_SHADER_STAGE_RAYGEN_BIT_KHR;
  std::span<const std::uint32_t> words;
};

// A hit group by indices into PipelineDescription::stages.
struct HitGroup {
  std::optional<std::uint32_t> closest_hit, any_hit, intersection;
};

struct PipelineDescription {
  std::vector<ShaderCode> stages;
  std::uint32_t ray_generation = 0;
  std::vector<std::uint32_t> misses;  // in miss-index order
  std::vector<HitGroup> hit_groups;   // in hit-record order
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  std::vector<std::uint32_t> constants;  // specialization constant i = constants[i], every stage
  std::uint32_t recursion = 1;
};

class Pipeline {
 public:
  Pipeline(const Context& context, const PipelineDescription& description);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  VkDescriptorSetLayout set_layout() const { return set_layout_; }
  // Binds pipeline and set, then traces width x height launch ids.
  void trace(VkCommandBuffer commands, VkDescriptorSet set, std::uint32_t width,
             std::uint32_t height) const;

 private:
  void create_layout(const PipelineDescription& description);
  void create_pipeline(const PipelineDescription& description);
  void create_binding_table(const PipelineDescription& description);

  const Context* context_;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  Buffer table_;
  VkStridedDeviceAddressRegionKHR generation_{}, miss_{}, hit_{}, callable_{};
};

}  // namespace a2rt::vulkan
