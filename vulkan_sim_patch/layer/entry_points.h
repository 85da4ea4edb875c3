// The layer's versions of Vulkan functions, one declaration per intercepted function. They do the
// bookkeeping and call the next layer; what is kept and why stands in state/ and capture/.
#pragma once

#include <vulkan/vulkan.h>

#include "layer/vulkan_14.h"

// Lists X(name without "vk"). A function is exposed under its core and its extension name.
#define A2RT_INTERCEPTED_DEVICE_FUNCTIONS(X)   \
  X(AllocateCommandBuffers)                    \
  X(AllocateDescriptorSets)                    \
  X(BeginCommandBuffer)                        \
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
  X(CmdPushDescriptorSet2KHR)                  \
  X(CmdPushDescriptorSetKHR)                   \
  X(CmdPushDescriptorSetWithTemplate2KHR)      \
  X(CmdPushDescriptorSetWithTemplateKHR)       \
  X(CmdTraceRaysIndirect2KHR)                  \
  X(CmdTraceRaysIndirectKHR)                   \
  X(CmdTraceRaysKHR)                           \
  X(CreateAccelerationStructureKHR)            \
  X(CreateComputePipelines)                    \
  X(CreateDescriptorSetLayout)                 \
  X(CreateDescriptorUpdateTemplate)            \
  X(CreateGraphicsPipelines)                   \
  X(CreateRayTracingPipelinesKHR)              \
  X(CreateShaderModule)                        \
  X(DestroyAccelerationStructureKHR)           \
  X(DestroyCommandPool)                        \
  X(DestroyDescriptorPool)                     \
  X(DestroyDescriptorSetLayout)                \
  X(DestroyDescriptorUpdateTemplate)           \
  X(DestroyPipeline)                           \
  X(DestroyShaderModule)                       \
  X(FreeCommandBuffers)                        \
  X(FreeDescriptorSets)                        \
  X(QueueSubmit)                               \
  X(QueueSubmit2)                              \
  X(ResetCommandBuffer)                        \
  X(ResetCommandPool)                          \
  X(ResetDescriptorPool)                       \
  X(UpdateDescriptorSetWithTemplate)           \
  X(UpdateDescriptorSets)

namespace a2rt::layer::entry {

// Declares `name` with the exact type of the Vulkan function.
template <class Pointer>
struct FunctionOf;
template <class Result, class... Arguments>
struct FunctionOf<Result(VKAPI_PTR*)(Arguments...)> {
  using Type = Result(Arguments...);
};

#define A2RT_DECLARE(name) FunctionOf<PFN_vk##name>::Type name;
A2RT_INTERCEPTED_DEVICE_FUNCTIONS(A2RT_DECLARE)
#undef A2RT_DECLARE

FunctionOf<PFN_vkCreateInstance>::Type CreateInstance;
FunctionOf<PFN_vkDestroyInstance>::Type DestroyInstance;
FunctionOf<PFN_vkCreateDevice>::Type CreateDevice;
FunctionOf<PFN_vkDestroyDevice>::Type DestroyDevice;

}  // namespace a2rt::layer::entry
