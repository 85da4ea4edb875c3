#include "harness/push_layout.h"

#include <cstddef>

namespace foreign {
namespace {

constexpr std::array kTypes = {VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR,
                               VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};

}  // namespace

PushLayout::PushLayout(App& app) : app_(app) {
  std::array<VkDescriptorSetLayoutBinding, kTypes.size()> bindings{};
  for (std::uint32_t i = 0; i < bindings.size(); ++i) {
    bindings[i] = {i, kTypes[i], 1, VK_SHADER_STAGE_ALL, nullptr};
  }
  VkDescriptorSetLayoutCreateInfo set{};
  set.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  set.flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR;
  set.bindingCount = static_cast<std::uint32_t>(bindings.size());
  set.pBindings = bindings.data();
  check(vkCreateDescriptorSetLayout(app_.device(), &set, nullptr, &set_layout_), "set layout");
  const VkPushConstantRange constants{VK_SHADER_STAGE_ALL, 0, 16};
  VkPipelineLayoutCreateInfo create{};
  create.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  create.setLayoutCount = 1;
  create.pSetLayouts = &set_layout_;
  create.pushConstantRangeCount = 1;
  create.pPushConstantRanges = &constants;
  check(vkCreatePipelineLayout(app_.device(), &create, nullptr, &layout_), "layout");
}

PushLayout::~PushLayout() {
  vkDestroyPipelineLayout(app_.device(), layout_, nullptr);
  vkDestroyDescriptorSetLayout(app_.device(), set_layout_, nullptr);
}

PushWrites::PushWrites(App& app, const Structure& tlas) : handle(tlas.handle) {
  structure = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR, nullptr, 1,
               &handle};
  picture = {app.picture().handle, 0, VK_WHOLE_SIZE};
  for (std::uint32_t i = 0; i < list.size(); ++i) {
    list[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    list[i].dstBinding = i;
    list[i].descriptorCount = 1;
    list[i].descriptorType = kTypes[i];
  }
  list[0].pNext = &structure;
  list[1].pBufferInfo = &picture;
}

VkDescriptorUpdateTemplate make_template(App& app, VkDescriptorSetLayout set_layout,
                                         VkPipelineLayout layout) {
  const std::array<VkDescriptorUpdateTemplateEntry, kTypes.size()> entries = {
      {{0, 0, 1, kTypes[0], offsetof(TemplateData, structure), sizeof(VkAccelerationStructureKHR)},
       {1, 0, 1, kTypes[1], offsetof(TemplateData, picture), sizeof(VkDescriptorBufferInfo)}}};
  VkDescriptorUpdateTemplateCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_UPDATE_TEMPLATE_CREATE_INFO;
  info.descriptorUpdateEntryCount = static_cast<std::uint32_t>(entries.size());
  info.pDescriptorUpdateEntries = entries.data();
  info.templateType = set_layout != VK_NULL_HANDLE
                          ? VK_DESCRIPTOR_UPDATE_TEMPLATE_TYPE_DESCRIPTOR_SET
                          : VK_DESCRIPTOR_UPDATE_TEMPLATE_TYPE_PUSH_DESCRIPTORS_KHR;
  info.descriptorSetLayout = set_layout;
  info.pipelineBindPoint = VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR;
  info.pipelineLayout = layout;
  VkDescriptorUpdateTemplate handle = VK_NULL_HANDLE;
  check(vkCreateDescriptorUpdateTemplate(app.device(), &info, nullptr, &handle), "template");
  return handle;
}

}  // namespace foreign
