// Which acceleration structures stand in which descriptors.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace a2rt::layer {

struct DescriptorSlot {
  std::uint32_t binding = 0;
  std::uint32_t element = 0;
  auto operator<=>(const DescriptorSlot&) const = default;
};

using StructureDescriptors = std::map<DescriptorSlot, VkAccelerationStructureKHR>;

class Descriptors {
 public:
  void layout_created(VkDescriptorSetLayout layout, const VkDescriptorSetLayoutCreateInfo& info);
  void layout_destroyed(VkDescriptorSetLayout layout);
  void template_created(VkDescriptorUpdateTemplate handle,
                        const VkDescriptorUpdateTemplateCreateInfo& info);
  void template_destroyed(VkDescriptorUpdateTemplate handle);
  // Where a template pushes to; nothing if the layer does not know it.
  std::optional<VkPipelineBindPoint> bind_point(VkDescriptorUpdateTemplate handle) const;
  void allocated(const VkDescriptorSetAllocateInfo& info, std::span<const VkDescriptorSet> sets);
  void freed(std::span<const VkDescriptorSet> sets);
  // All sets of a pool that was reset or destroyed.
  void pool_emptied(VkDescriptorPool pool);

  void update(std::span<const VkWriteDescriptorSet> writes,
              std::span<const VkCopyDescriptorSet> copies);
  void update(VkDescriptorSet set, VkDescriptorUpdateTemplate handle, const void* data);

  // Pushed descriptors are added to `target`; they belong to a command buffer, not to a set.
  static void push(StructureDescriptors& target, std::span<const VkWriteDescriptorSet> writes);
  void push(StructureDescriptors& target, VkDescriptorUpdateTemplate handle,
            const void* data) const;

  std::optional<VkAccelerationStructureKHR> find(VkDescriptorSet set, DescriptorSlot slot) const;

 private:
  // Descriptors per binding number; an update past the end of a binding goes on in the next.
  using Layout = std::map<std::uint32_t, std::uint32_t>;
  struct Template {
    VkPipelineBindPoint bind_point = VK_PIPELINE_BIND_POINT_GRAPHICS;
    std::vector<VkDescriptorUpdateTemplateEntry> entries;
  };
  struct Set {
    VkDescriptorPool pool = VK_NULL_HANDLE;
    std::shared_ptr<const Layout> layout;
    StructureDescriptors structures;
  };

  static DescriptorSlot place(const Layout* layout, DescriptorSlot first, std::uint32_t offset);
  static void write(StructureDescriptors& target, const Layout* layout,
                    const VkWriteDescriptorSet& write);
  static void apply_template(StructureDescriptors& target, const Layout* layout,
                             std::span<const VkDescriptorUpdateTemplateEntry> entries,
                             const void* data);

  mutable std::mutex mutex_;
  std::unordered_map<VkDescriptorSetLayout, std::shared_ptr<const Layout>> layouts_;
  std::unordered_map<VkDescriptorUpdateTemplate, Template> templates_;
  std::unordered_map<VkDescriptorSet, Set> sets_;
};

}  // namespace a2rt::layer
