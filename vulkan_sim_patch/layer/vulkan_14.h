// Declarations of VK_KHR_maintenance6 (Vulkan 1.4) for Vulkan headers that are older than it. The
// driver has these functions whatever the headers of this build say.
#pragma once

#include <vulkan/vulkan.h>

#ifndef VK_KHR_maintenance6

struct VkBindDescriptorSetsInfoKHR {
  VkStructureType sType;
  const void* pNext;
  VkShaderStageFlags stageFlags;
  VkPipelineLayout layout;
  uint32_t firstSet;
  uint32_t descriptorSetCount;
  const VkDescriptorSet* pDescriptorSets;
  uint32_t dynamicOffsetCount;
  const uint32_t* pDynamicOffsets;
};

struct VkPushDescriptorSetInfoKHR {
  VkStructureType sType;
  const void* pNext;
  VkShaderStageFlags stageFlags;
  VkPipelineLayout layout;
  uint32_t set;
  uint32_t descriptorWriteCount;
  const VkWriteDescriptorSet* pDescriptorWrites;
};

struct VkPushDescriptorSetWithTemplateInfoKHR {
  VkStructureType sType;
  const void* pNext;
  VkDescriptorUpdateTemplate descriptorUpdateTemplate;
  VkPipelineLayout layout;
  uint32_t set;
  const void* pData;
};

using PFN_vkCmdBindDescriptorSets2KHR = void(VKAPI_PTR*)(VkCommandBuffer,
                                                         const VkBindDescriptorSetsInfoKHR*);
using PFN_vkCmdPushDescriptorSet2KHR = void(VKAPI_PTR*)(VkCommandBuffer,
                                                        const VkPushDescriptorSetInfoKHR*);
using PFN_vkCmdPushDescriptorSetWithTemplate2KHR =
    void(VKAPI_PTR*)(VkCommandBuffer, const VkPushDescriptorSetWithTemplateInfoKHR*);

#endif
