// Work that may trace rays: traces, dispatches, draws.
#include <cstring>
#include <memory>

#include "layer/device.h"
#include "layer/entry_points.h"

namespace a2rt::layer::entry {
namespace {

template <class T>
T read_device_memory(VkDeviceAddress address) {
  T value;
  std::memcpy(&value, reinterpret_cast<const void*>(address), sizeof(value));
  return value;
}

VkDeviceAddress address_of(Device& device, VkBuffer buffer, VkDeviceSize offset) {
  const VkBufferDeviceAddressInfo info{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, nullptr,
                                       buffer};
  return device.table().GetBufferDeviceAddress(device.handle(), &info) + offset;
}

// Records a callback before work of `kind` if its pipeline traces rays. `size` is called when the
// work is about to execute, because indirect arguments are not known earlier.
template <class Size>
void before_work(VkCommandBuffer commands, BindPointKind kind, const Size& size) {
  Device& device = device_of(commands);
  if (device.session() == nullptr) {
    return;
  }
  const auto state = device.commands().find(commands);
  const BindPoint& point = state->point(kind);
  if (point.pipeline == nullptr || !point.pipeline->instrumented()) {
    return;
  }
  ++state->dispatch_count;
  auto work = std::make_shared<BoundWork>(BoundWork{point.pipeline, point.sets});
  device.add_callback(commands, [&device, work, size] {
    device.begin_work(work->pipeline->kind, size(*work->pipeline), {work.get(), 1});
  });
}

Device::Extent invocations(const PipelineState& pipeline, const Device::Extent& groups) {
  Device::Extent out;
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = groups[i] * pipeline.local_size[i];
  }
  return out;
}

// Remembers what a draw has bound; the render pass's callback says which structures that means.
void note_draw(VkCommandBuffer commands) {
  Device& device = device_of(commands);
  if (device.session() == nullptr) {
    return;
  }
  const auto state = device.commands().find(commands);
  const BindPoint& point = state->point(BindPointKind::kGraphics);
  if (point.pipeline == nullptr || !point.pipeline->instrumented()) {
    return;
  }
  auto& draws = state->open_pass != nullptr ? state->open_pass->draws : state->inherited_draws;
  draws.push_back({point.pipeline, point.sets});
}

// Host callbacks cannot stand inside a render pass, so there is one before each.
void begin_pass(VkCommandBuffer commands, const VkRect2D& area) {
  Device& device = device_of(commands);
  if (device.session() == nullptr) {
    return;
  }
  const auto state = device.commands().find(commands);
  auto pass = std::make_shared<DrawPass>();
  pass->width = static_cast<std::uint32_t>(area.offset.x) + area.extent.width;
  pass->height = static_cast<std::uint32_t>(area.offset.y) + area.extent.height;
  state->passes.push_back(pass);
  state->open_pass = pass;
  device.add_callback(commands, [&device, pass] {
    if (!pass->draws.empty()) {
      device.begin_work(PipelineState::Kind::kGraphics, {pass->width, pass->height, 1},
                        pass->draws);
    }
  });
}

void end_pass(VkCommandBuffer commands) {
  Device& device = device_of(commands);
  if (device.session() != nullptr) {
    device.commands().find(commands)->open_pass.reset();
  }
}

}  // namespace

void CmdTraceRaysKHR(VkCommandBuffer commands, const VkStridedDeviceAddressRegionKHR* raygen,
                     const VkStridedDeviceAddressRegionKHR* miss,
                     const VkStridedDeviceAddressRegionKHR* hit,
                     const VkStridedDeviceAddressRegionKHR* callable, std::uint32_t width,
                     std::uint32_t height, std::uint32_t depth) {
  before_work(commands, BindPointKind::kRayTracing,
              [=](const PipelineState&) { return Device::Extent{width, height, depth}; });
  device_of(commands).table().CmdTraceRaysKHR(commands, raygen, miss, hit, callable, width, height,
                                              depth);
}

void CmdTraceRaysIndirectKHR(VkCommandBuffer commands,
                             const VkStridedDeviceAddressRegionKHR* raygen,
                             const VkStridedDeviceAddressRegionKHR* miss,
                             const VkStridedDeviceAddressRegionKHR* hit,
                             const VkStridedDeviceAddressRegionKHR* callable,
                             VkDeviceAddress address) {
  before_work(commands, BindPointKind::kRayTracing, [address](const PipelineState&) {
    const auto size = read_device_memory<VkTraceRaysIndirectCommandKHR>(address);
    return Device::Extent{size.width, size.height, size.depth};
  });
  device_of(commands).table().CmdTraceRaysIndirectKHR(commands, raygen, miss, hit, callable,
                                                      address);
}

void CmdTraceRaysIndirect2KHR(VkCommandBuffer commands, VkDeviceAddress address) {
  before_work(commands, BindPointKind::kRayTracing, [address](const PipelineState&) {
    const auto all = read_device_memory<VkTraceRaysIndirectCommand2KHR>(address);
    return Device::Extent{all.width, all.height, all.depth};
  });
  device_of(commands).table().CmdTraceRaysIndirect2KHR(commands, address);
}

void CmdDispatch(VkCommandBuffer commands, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  before_work(commands, BindPointKind::kCompute,
              [=](const PipelineState& pipeline) { return invocations(pipeline, {x, y, z}); });
  device_of(commands).table().CmdDispatch(commands, x, y, z);
}

void CmdDispatchBase(VkCommandBuffer commands, std::uint32_t base_x, std::uint32_t base_y,
                     std::uint32_t base_z, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  if (base_x != 0 || base_y != 0 || base_z != 0) {
    device_of(commands).refuse_once(
        "vkCmdDispatchBase with a base other than 0: launch ids of its rays are offset by the "
        "base");
  }
  before_work(commands, BindPointKind::kCompute, [=](const PipelineState& pipeline) {
    return invocations(pipeline, {base_x + x, base_y + y, base_z + z});
  });
  device_of(commands).table().CmdDispatchBase(commands, base_x, base_y, base_z, x, y, z);
}

void CmdDispatchIndirect(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset) {
  Device& device = device_of(commands);
  before_work(
      commands, BindPointKind::kCompute, [&device, buffer, offset](const PipelineState& pipeline) {
        const auto groups =
            read_device_memory<VkDispatchIndirectCommand>(address_of(device, buffer, offset));
        return invocations(pipeline, {groups.x, groups.y, groups.z});
      });
  device.table().CmdDispatchIndirect(commands, buffer, offset);
}

void CmdDraw(VkCommandBuffer commands, std::uint32_t vertices, std::uint32_t instances,
             std::uint32_t first_vertex, std::uint32_t first_instance) {
  note_draw(commands);
  device_of(commands).table().CmdDraw(commands, vertices, instances, first_vertex, first_instance);
}

void CmdDrawIndexed(VkCommandBuffer commands, std::uint32_t indices, std::uint32_t instances,
                    std::uint32_t first_index, std::int32_t vertex_offset,
                    std::uint32_t first_instance) {
  note_draw(commands);
  device_of(commands).table().CmdDrawIndexed(commands, indices, instances, first_index,
                                             vertex_offset, first_instance);
}

void CmdDrawIndirect(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset,
                     std::uint32_t count, std::uint32_t stride) {
  note_draw(commands);
  device_of(commands).table().CmdDrawIndirect(commands, buffer, offset, count, stride);
}

void CmdDrawIndexedIndirect(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset,
                            std::uint32_t count, std::uint32_t stride) {
  note_draw(commands);
  device_of(commands).table().CmdDrawIndexedIndirect(commands, buffer, offset, count, stride);
}

void CmdDrawIndirectCount(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset,
                          VkBuffer count_buffer, VkDeviceSize count_offset, std::uint32_t most,
                          std::uint32_t stride) {
  note_draw(commands);
  device_of(commands).table().CmdDrawIndirectCount(commands, buffer, offset, count_buffer,
                                                   count_offset, most, stride);
}

void CmdDrawIndexedIndirectCount(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset,
                                 VkBuffer count_buffer, VkDeviceSize count_offset,
                                 std::uint32_t most, std::uint32_t stride) {
  note_draw(commands);
  device_of(commands).table().CmdDrawIndexedIndirectCount(commands, buffer, offset, count_buffer,
                                                          count_offset, most, stride);
}

void CmdDrawMeshTasksEXT(VkCommandBuffer commands, std::uint32_t x, std::uint32_t y,
                         std::uint32_t z) {
  note_draw(commands);
  device_of(commands).table().CmdDrawMeshTasksEXT(commands, x, y, z);
}

void CmdDrawMeshTasksIndirectEXT(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset,
                                 std::uint32_t count, std::uint32_t stride) {
  note_draw(commands);
  device_of(commands).table().CmdDrawMeshTasksIndirectEXT(commands, buffer, offset, count, stride);
}

void CmdDrawMeshTasksIndirectCountEXT(VkCommandBuffer commands, VkBuffer buffer,
                                      VkDeviceSize offset, VkBuffer count_buffer,
                                      VkDeviceSize count_offset, std::uint32_t most,
                                      std::uint32_t stride) {
  note_draw(commands);
  device_of(commands).table().CmdDrawMeshTasksIndirectCountEXT(
      commands, buffer, offset, count_buffer, count_offset, most, stride);
}

void CmdDrawMultiEXT(VkCommandBuffer commands, std::uint32_t count, const VkMultiDrawInfoEXT* draws,
                     std::uint32_t instances, std::uint32_t first_instance, std::uint32_t stride) {
  note_draw(commands);
  device_of(commands).table().CmdDrawMultiEXT(commands, count, draws, instances, first_instance,
                                              stride);
}

void CmdDrawMultiIndexedEXT(VkCommandBuffer commands, std::uint32_t count,
                            const VkMultiDrawIndexedInfoEXT* draws, std::uint32_t instances,
                            std::uint32_t first_instance, std::uint32_t stride,
                            const std::int32_t* vertex_offset) {
  note_draw(commands);
  device_of(commands).table().CmdDrawMultiIndexedEXT(commands, count, draws, instances,
                                                     first_instance, stride, vertex_offset);
}

void CmdDrawIndirectByteCountEXT(VkCommandBuffer commands, std::uint32_t instances,
                                 std::uint32_t first_instance, VkBuffer counter,
                                 VkDeviceSize offset, std::uint32_t counter_offset,
                                 std::uint32_t stride) {
  note_draw(commands);
  device_of(commands).table().CmdDrawIndirectByteCountEXT(commands, instances, first_instance,
                                                          counter, offset, counter_offset, stride);
}

void CmdBeginRenderPass(VkCommandBuffer commands, const VkRenderPassBeginInfo* info,
                        VkSubpassContents contents) {
  begin_pass(commands, info->renderArea);
  device_of(commands).table().CmdBeginRenderPass(commands, info, contents);
}

void CmdBeginRenderPass2(VkCommandBuffer commands, const VkRenderPassBeginInfo* info,
                         const VkSubpassBeginInfo* begin) {
  begin_pass(commands, info->renderArea);
  device_of(commands).table().CmdBeginRenderPass2(commands, info, begin);
}

void CmdBeginRendering(VkCommandBuffer commands, const VkRenderingInfo* info) {
  if ((info->flags & VK_RENDERING_RESUMING_BIT) == 0) {
    begin_pass(commands, info->renderArea);
  } else {
    device_of(commands).refuse_once(
        "draws in a resumed dynamic rendering are counted to the work before it");
  }
  device_of(commands).table().CmdBeginRendering(commands, info);
}

void CmdEndRenderPass(VkCommandBuffer commands) {
  end_pass(commands);
  device_of(commands).table().CmdEndRenderPass(commands);
}

void CmdEndRenderPass2(VkCommandBuffer commands, const VkSubpassEndInfo* info) {
  end_pass(commands);
  device_of(commands).table().CmdEndRenderPass2(commands, info);
}

void CmdEndRendering(VkCommandBuffer commands) {
  end_pass(commands);
  device_of(commands).table().CmdEndRendering(commands);
}

}  // namespace a2rt::layer::entry
