// Descriptor sets, layouts and templates.
#include "layer/device.h"
#include "layer/entry_points.h"

namespace a2rt::layer::entry {

VkResult CreateDescriptorSetLayout(VkDevice handle, const VkDescriptorSetLayoutCreateInfo* info,
                                   const VkAllocationCallbacks* allocator,
                                   VkDescriptorSetLayout* layout) {
  Device& device = device_of(handle);
  const VkResult result = device.table().CreateDescriptorSetLayout(handle, info, allocator, layout);
  if (result == VK_SUCCESS) {
    device.descriptors().layout_created(*layout, *info);
  }
  return result;
}

void DestroyDescriptorSetLayout(VkDevice handle, VkDescriptorSetLayout layout,
                                const VkAllocationCallbacks* allocator) {
  Device& device = device_of(handle);
  device.descriptors().layout_destroyed(layout);
  device.table().DestroyDescriptorSetLayout(handle, layout, allocator);
}

VkResult CreateDescriptorUpdateTemplate(VkDevice handle,
                                        const VkDescriptorUpdateTemplateCreateInfo* info,
                                        const VkAllocationCallbacks* allocator,
                                        VkDescriptorUpdateTemplate* update) {
  Device& device = device_of(handle);
  const VkResult result =
      device.table().CreateDescriptorUpdateTemplate(handle, info, allocator, update);
  if (result == VK_SUCCESS) {
    device.descriptors().template_created(*update, *info);
  }
  return result;
}

void DestroyDescriptorUpdateTemplate(VkDevice handle, VkDescriptorUpdateTemplate update,
                                     const VkAllocationCallbacks* allocator) {
  Device& device = device_of(handle);
  device.descriptors().template_destroyed(update);
  device.table().DestroyDescriptorUpdateTemplate(handle, update, allocator);
}

VkResult AllocateDescriptorSets(VkDevice handle, const VkDescriptorSetAllocateInfo* info,
                                VkDescriptorSet* sets) {
  Device& device = device_of(handle);
  const VkResult result = device.table().AllocateDescriptorSets(handle, info, sets);
  if (result == VK_SUCCESS) {
    device.descriptors().allocated(*info, {sets, info->descriptorSetCount});
  }
  return result;
}

VkResult FreeDescriptorSets(VkDevice handle, VkDescriptorPool pool, std::uint32_t count,
                            const VkDescriptorSet* sets) {
  Device& device = device_of(handle);
  device.descriptors().freed({sets, count});
  return device.table().FreeDescriptorSets(handle, pool, count, sets);
}

VkResult ResetDescriptorPool(VkDevice handle, VkDescriptorPool pool,
                             VkDescriptorPoolResetFlags flags) {
  Device& device = device_of(handle);
  device.descriptors().pool_emptied(pool);
  return device.table().ResetDescriptorPool(handle, pool, flags);
}

void DestroyDescriptorPool(VkDevice handle, VkDescriptorPool pool,
                           const VkAllocationCallbacks* allocator) {
  Device& device = device_of(handle);
  device.descriptors().pool_emptied(pool);
  device.table().DestroyDescriptorPool(handle, pool, allocator);
}

void UpdateDescriptorSets(VkDevice handle, std::uint32_t write_count,
                          const VkWriteDescriptorSet* writes, std::uint32_t copy_count,
                          const VkCopyDescriptorSet* copies) {
  Device& device = device_of(handle);
  device.table().UpdateDescriptorSets(handle, write_count, writes, copy_count, copies);
  device.descriptors().update({writes, write_count}, {copies, copy_count});
}

void UpdateDescriptorSetWithTemplate(VkDevice handle, VkDescriptorSet set,
                                     VkDescriptorUpdateTemplate update, const void* data) {
  Device& device = device_of(handle);
  device.table().UpdateDescriptorSetWithTemplate(handle, set, update, data);
  device.descriptors().update(set, update, data);
}

}  // namespace a2rt::layer::entry
