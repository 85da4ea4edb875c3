// Command buffers' life and what is bound in them.
#include <optional>
#include <span>
#include <utility>
#include <vector>

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

// The bind points that stages belong to, as the calls of VK_KHR_maintenance6 name them.
std::vector<BindPointKind> kinds_of(VkShaderStageFlags stages) {
  constexpr VkShaderStageFlags kGraphics =
      VK_SHADER_STAGE_ALL_GRAPHICS | VK_SHADER_STAGE_TASK_BIT_EXT | VK_SHADER_STAGE_MESH_BIT_EXT;
  constexpr VkShaderStageFlags kRayTracing =
      VK_SHADER_STAGE_RAYGEN_BIT_KHR | VK_SHADER_STAGE_ANY_HIT_BIT_KHR |
      VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR | VK_SHADER_STAGE_MISS_BIT_KHR |
      VK_SHADER_STAGE_INTERSECTION_BIT_KHR | VK_SHADER_STAGE_CALLABLE_BIT_KHR;
  std::vector<BindPointKind> kinds;
  if ((stages & kGraphics) != 0) {
    kinds.push_back(BindPointKind::kGraphics);
  }
  if ((stages & VK_SHADER_STAGE_COMPUTE_BIT) != 0) {
    kinds.push_back(BindPointKind::kCompute);
  }
  if ((stages & kRayTracing) != 0) {
    kinds.push_back(BindPointKind::kRayTracing);
  }
  return kinds;
}

std::vector<BindPointKind> kinds_at(std::optional<VkPipelineBindPoint> point) {
  const auto kind = point ? kind_of(*point) : std::nullopt;
  return kind ? std::vector{*kind} : std::vector<BindPointKind>{};
}

void note_sets(VkCommandBuffer commands, const std::vector<BindPointKind>& kinds,
               std::uint32_t first, std::span<const VkDescriptorSet> sets) {
  Device& device = device_of(commands);
  if (device.session() == nullptr) {
    return;
  }
  for (const BindPointKind kind : kinds) {
    BoundSets& bound = device.commands().find(commands)->point(kind).sets;
    for (std::uint32_t i = 0; i < sets.size(); ++i) {
      bound[first + i] = {sets[i], {}};
    }
  }
}

// `push(pushed)` adds the new descriptors to those pushed before.
template <class Push>
void note_pushed(VkCommandBuffer commands, const std::vector<BindPointKind>& kinds,
                 std::uint32_t set, const Push& push) {
  Device& device = device_of(commands);
  if (device.session() == nullptr) {
    return;
  }
  for (const BindPointKind kind : kinds) {
    BoundSet& bound = device.commands().find(commands)->point(kind).sets[set];
    bound.set = VK_NULL_HANDLE;
    push(bound.pushed);
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
  note_sets(commands, kinds_at(point), first, {sets, count});
  device_of(commands).table().CmdBindDescriptorSets(commands, point, layout, first, count, sets,
                                                    offset_count, offsets);
}

void CmdBindDescriptorSets2KHR(VkCommandBuffer commands, const VkBindDescriptorSetsInfoKHR* info) {
  note_sets(commands, kinds_of(info->stageFlags), info->firstSet,
            {info->pDescriptorSets, info->descriptorSetCount});
  device_of(commands).table().CmdBindDescriptorSets2KHR(commands, info);
}

void CmdPushDescriptorSetKHR(VkCommandBuffer commands, VkPipelineBindPoint point,
                             VkPipelineLayout layout, std::uint32_t set, std::uint32_t count,
                             const VkWriteDescriptorSet* writes) {
  note_pushed(commands, kinds_at(point), set,
              [&](StructureDescriptors& pushed) { Descriptors::push(pushed, {writes, count}); });
  device_of(commands).table().CmdPushDescriptorSetKHR(commands, point, layout, set, count, writes);
}

void CmdPushDescriptorSet2KHR(VkCommandBuffer commands, const VkPushDescriptorSetInfoKHR* info) {
  note_pushed(commands, kinds_of(info->stageFlags), info->set, [&](StructureDescriptors& pushed) {
    Descriptors::push(pushed, {info->pDescriptorWrites, info->descriptorWriteCount});
  });
  device_of(commands).table().CmdPushDescriptorSet2KHR(commands, info);
}

void CmdPushDescriptorSetWithTemplateKHR(VkCommandBuffer commands,
                                         VkDescriptorUpdateTemplate update, VkPipelineLayout layout,
                                         std::uint32_t set, const void* data) {
  Device& device = device_of(commands);
  note_pushed(
      commands, kinds_at(device.descriptors().bind_point(update)), set,
      [&](StructureDescriptors& pushed) { device.descriptors().push(pushed, update, data); });
  device.table().CmdPushDescriptorSetWithTemplateKHR(commands, update, layout, set, data);
}

void CmdPushDescriptorSetWithTemplate2KHR(VkCommandBuffer commands,
                                          const VkPushDescriptorSetWithTemplateInfoKHR* info) {
  Device& device = device_of(commands);
  note_pushed(commands, kinds_at(device.descriptors().bind_point(info->descriptorUpdateTemplate)),
              info->set, [&](StructureDescriptors& pushed) {
                device.descriptors().push(pushed, info->descriptorUpdateTemplate, info->pData);
              });
  device.table().CmdPushDescriptorSetWithTemplate2KHR(commands, info);
}

}  // namespace a2rt::layer::entry
