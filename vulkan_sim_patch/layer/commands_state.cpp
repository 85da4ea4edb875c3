// Command buffers' life and what is bound in them.
#include <optional>
#include <utility>

#include "layer/device.h"
#include "layer/entry_points.h"

namespace a2rt::layer::entry {
namespace {

std::optional<BindPointKind> kind_of(VkPipelineBindPoint point) {
  switch (point) {
    case VK_PIPELINE_BIND_POINT_GRAPHICS:
      return BindPointKind::kGraphics;
    case VK_PIPELINE_BIND_POINT_COMPUTE:
      return BindPointKind::kCompute;
    case VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR:
      return BindPointKind::kRayTracing;
    default:
      return std::nullopt;
  }
}

}  // namespace

VkResult AllocateCommandBuffers(VkDevice handle, const VkCommandBufferAllocateInfo* info,
                                VkCommandBuffer* buffers) {
  Device& device = device_of(handle);
  const VkResult result = device.table().AllocateCommandBuffers(handle, info, buffers);
  if (result == VK_SUCCESS) {
    device.commands().allocated(info->commandPool, buffers, info->commandBufferCount);
  }
  return result;
}

void FreeCommandBuffers(VkDevice handle, VkCommandPool pool, std::uint32_t count,
                        const VkCommandBuffer* buffers) {
  Device& device = device_of(handle);
  device.forget_callbacks(device.commands().freed(buffers, count));
  device.table().FreeCommandBuffers(handle, pool, count, buffers);
}

VkResult ResetCommandPool(VkDevice handle, VkCommandPool pool, VkCommandPoolResetFlags flags) {
  Device& device = device_of(handle);
  device.forget_callbacks(device.commands().pool_reset(pool));
  return device.table().ResetCommandPool(handle, pool, flags);
}

void DestroyCommandPool(VkDevice handle, VkCommandPool pool,
                        const VkAllocationCallbacks* allocator) {
  Device& device = device_of(handle);
  if (pool != VK_NULL_HANDLE) {
    device.forget_callbacks(device.commands().pool_destroyed(pool));
  }
  device.table().DestroyCommandPool(handle, pool, allocator);
}

VkResult BeginCommandBuffer(VkCommandBuffer commands, const VkCommandBufferBeginInfo* info) {
  Device& device = device_of(commands);
  device.forget_callbacks(device.commands().reset(commands));
  return device.table().BeginCommandBuffer(commands, info);
}

VkResult ResetCommandBuffer(VkCommandBuffer commands, VkCommandBufferResetFlags flags) {
  Device& device = device_of(commands);
  device.forget_callbacks(device.commands().reset(commands));
  return device.table().ResetCommandBuffer(commands, flags);
}

void CmdExecuteCommands(VkCommandBuffer commands, std::uint32_t count,
                        const VkCommandBuffer* secondaries) {
  Device& device = device_of(commands);
  const auto state = device.commands().find(commands);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto other = device.commands().find(secondaries[i]);
    state->callback_count += other->callback_count;
    state->dispatch_count += other->dispatch_count;
    state->passes.insert(state->passes.end(), other->passes.begin(), other->passes.end());
    if (state->open_pass != nullptr) {
      auto& draws = state->open_pass->draws;
      draws.insert(draws.end(), other->inherited_draws.begin(), other->inherited_draws.end());
    }
  }
  // Nothing stays bound after secondaries.
  state->points = {};
  device.table().CmdExecuteCommands(commands, count, secondaries);
}

void CmdBindPipeline(VkCommandBuffer commands, VkPipelineBindPoint point, VkPipeline pipeline) {
  Device& device = device_of(commands);
  if (const auto kind = kind_of(point); kind && device.session() != nullptr) {
    device.commands().find(commands)->point(*kind).pipeline = device.shaders().pipeline(pipeline);
  }
  device.table().CmdBindPipeline(commands, point, pipeline);
}

void CmdBindDescriptorSets(VkCommandBuffer commands, VkPipelineBindPoint point,
                           VkPipelineLayout layout, std::uint32_t first, std::uint32_t count,
                           const VkDescriptorSet* sets, std::uint32_t offset_count,
                           const std::uint32_t* offsets) {
  Device& device = device_of(commands);
  if (const auto kind = kind_of(point); kind && device.session() != nullptr) {
    BoundSets& bound = device.commands().find(commands)->point(*kind).sets;
    for (std::uint32_t i = 0; i < count; ++i) {
      bound[first + i] = {sets[i], {}};
    }
  }
  device.table().CmdBindDescriptorSets(commands, point, layout, first, count, sets, offset_count,
                                       offsets);
}

void CmdPushDescriptorSetKHR(VkCommandBuffer commands, VkPipelineBindPoint point,
                             VkPipelineLayout layout, std::uint32_t set, std::uint32_t count,
                             const VkWriteDescriptorSet* writes) {
  Device& device = device_of(commands);
  if (const auto kind = kind_of(point); kind && device.session() != nullptr) {
    BoundSet& bound = device.commands().find(commands)->point(*kind).sets[set];
    bound.set = VK_NULL_HANDLE;
    Descriptors::push(bound.pushed, {writes, count});
  }
  device.table().CmdPushDescriptorSetKHR(commands, point, layout, set, count, writes);
}

void CmdPushDescriptorSetWithTemplateKHR(VkCommandBuffer commands,
                                         VkDescriptorUpdateTemplate update, VkPipelineLayout layout,
                                         std::uint32_t set, const void* data) {
  Device& device = device_of(commands);
  if (const auto point = device.descriptors().bind_point(update);
      point && device.session() != nullptr) {
    if (const auto kind = kind_of(*point)) {
      BoundSet& bound = device.commands().find(commands)->point(*kind).sets[set];
      bound.set = VK_NULL_HANDLE;
      device.descriptors().push(bound.pushed, update, data);
    }
  }
  device.table().CmdPushDescriptorSetWithTemplateKHR(commands, update, layout, set, data);
}

}  // namespace a2rt::layer::entry
