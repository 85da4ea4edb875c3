// The functions of the next layer or the driver that the layer calls.
#pragma once

#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include "layer/vulkan_14.h"

namespace a2rt::layer {

#define A2RT_INSTANCE_FUNCTIONS(X)      \
  X(DestroyInstance)                    \
  X(EnumerateDeviceExtensionProperties) \
  X(GetPhysicalDeviceMemoryProperties)  \
  X(GetPhysicalDeviceProperties2)

// Core or extension functions; a name ending in KHR is also looked up without it and vice versa.
#define A2RT_DEVICE_FUNCTIONS(X)               \
  X(AllocateCommandBuffers)                    \
  X(AllocateDescriptorSets)                    \
  X(AllocateMemory)                            \
  X(BeginCommandBuffer)                        \
  X(BindBufferMemory)                          \
  X(BuildAccelerationStructuresKHR)            \
  X(CmdBeginRenderPass)                        \
  X(CmdBeginRenderPass2)                       \
  X(CmdBeginRendering)                         \
  X(CmdBindDescriptorSets)                     \
  X(CmdBindDescriptorSets2KHR)                 \
  X(CmdBindPipeline)                           \
  X(CmdBuildAccelerationStructuresIndirectKHR) \
  X(CmdBuildAccelerationStructuresKHR)         \
  X(CmdCopyAccelerationStructureKHR)           \
  X(CmdCopyAccelerationStructureToMemoryKHR)   \
  X(CmdCopyMemoryToAccelerationStructureKHR)   \
  X(CmdDispatch)                               \
  X(CmdDispatchBase)                           \
  X(CmdDispatchIndirect)                       \
  X(CmdDraw)                                   \
  X(CmdDrawIndexed)                            \
  X(CmdDrawIndexedIndirect)                    \
  X(CmdDrawIndexedIndirectCount)               \
  X(CmdDrawIndirect)                           \
  X(CmdDrawIndirectByteCountEXT)               \
  X(CmdDrawIndirectCount)                      \
  X(CmdDrawMeshTasksEXT)                       \
  X(CmdDrawMeshTasksIndirectCountEXT)          \
  X(CmdDrawMeshTasksIndirectEXT)               \
  X(CmdDrawMultiEXT)                           \
  X(CmdDrawMultiIndexedEXT)                    \
  X(CmdEndRenderPass)                          \
  X(CmdEndRenderPass2)                         \
  X(CmdEndRendering)                           \
  X(CmdExecuteCommands)                        \
  X(CmdPipelineBarrier)                        \
  X(CmdPushDescriptorSet2KHR)                  \
  X(CmdPushDescriptorSetKHR)                   \
  X(CmdPushDescriptorSetWithTemplate2KHR)      \
  X(CmdPushDescriptorSetWithTemplateKHR)       \
  X(CmdResetEvent)                             \
  X(CmdSetEvent)                               \
  X(CmdTraceRaysIndirect2KHR)                  \
  X(CmdTraceRaysIndirectKHR)                   \
  X(CmdTraceRaysKHR)                           \
  X(CmdUpdateBuffer)                           \
  X(CmdWaitEvents)                             \
  X(CreateAccelerationStructureKHR)            \
  X(CreateBuffer)                              \
  X(CreateCommandPool)                         \
  X(CreateComputePipelines)                    \
  X(CreateDescriptorSetLayout)                 \
  X(CreateDescriptorUpdateTemplate)            \
  X(CreateEvent)                               \
  X(CreateGraphicsPipelines)                   \
  X(CreateRayTracingPipelinesKHR)              \
  X(CreateShaderModule)                        \
  X(DestroyAccelerationStructureKHR)           \
  X(DestroyBuffer)                             \
  X(DestroyCommandPool)                        \
  X(DestroyDescriptorPool)                     \
  X(DestroyDescriptorSetLayout)                \
  X(DestroyDescriptorUpdateTemplate)           \
  X(DestroyDevice)                             \
  X(DestroyEvent)                              \
  X(DestroyPipeline)                           \
  X(DestroyShaderModule)                       \
  X(EndCommandBuffer)                          \
  X(FreeCommandBuffers)                        \
  X(FreeDescriptorSets)                        \
  X(FreeMemory)                                \
  X(GetAccelerationStructureDeviceAddressKHR)  \
  X(GetBufferDeviceAddress)                    \
  X(GetBufferMemoryRequirements)               \
  X(GetEventStatus)                            \
  X(MapMemory)                                 \
  X(QueueSubmit)                               \
  X(QueueSubmit2)                              \
  X(ResetCommandBuffer)                        \
  X(ResetCommandPool)                          \
  X(ResetDescriptorPool)                       \
  X(ResetEvent)                                \
  X(SetEvent)                                  \
  X(UpdateDescriptorSetWithTemplate)           \
  X(UpdateDescriptorSets)

#define A2RT_MEMBER(name) PFN_vk##name name = nullptr;

struct InstanceTable {
  PFN_vkGetInstanceProcAddr GetInstanceProcAddr = nullptr;
  A2RT_INSTANCE_FUNCTIONS(A2RT_MEMBER)
};

struct DeviceTable {
  PFN_vkGetDeviceProcAddr GetDeviceProcAddr = nullptr;
  A2RT_DEVICE_FUNCTIONS(A2RT_MEMBER)
};

#undef A2RT_MEMBER

InstanceTable load_instance_table(VkInstance instance, PFN_vkGetInstanceProcAddr next);
DeviceTable load_device_table(VkDevice device, PFN_vkGetDeviceProcAddr next);

}  // namespace a2rt::layer
