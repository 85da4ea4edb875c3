// Submits: the layer says what will ask for host code, and appends a mark of its own.
#include <span>
#include <vector>

#include "layer/device.h"
#include "layer/entry_points.h"

namespace a2rt::layer::entry {
namespace {

std::vector<VkCommandBuffer> buffers_of(std::span<const VkSubmitInfo> submits) {
  std::vector<VkCommandBuffer> all;
  for (const VkSubmitInfo& submit : submits) {
    all.insert(all.end(), submit.pCommandBuffers,
               submit.pCommandBuffers + submit.commandBufferCount);
  }
  return all;
}

std::vector<VkCommandBuffer> buffers_of(std::span<const VkSubmitInfo2> submits) {
  std::vector<VkCommandBuffer> all;
  for (const VkSubmitInfo2& submit : submits) {
    for (std::uint32_t i = 0; i < submit.commandBufferInfoCount; ++i) {
      all.push_back(submit.pCommandBufferInfos[i].commandBuffer);
    }
  }
  return all;
}

// Submits with the epilogue behind; `wrap` turns the epilogue into one more submit structure.
template <class Submit, class Wrap, class Next>
VkResult submit(VkQueue queue, std::span<const Submit> submits, const Wrap& wrap,
                const Next& next) {
  Device& device = device_of(queue);
  const auto buffers = buffers_of(submits);
  const VkCommandBuffer epilogue = device.before_submit(buffers);
  std::vector<Submit> all(submits.begin(), submits.end());
  if (epilogue != VK_NULL_HANDLE) {
    all.push_back(wrap(epilogue));
  }
  const VkResult result = next(device.table(), static_cast<std::uint32_t>(all.size()), all.data());
  if (result != VK_SUCCESS) {
    device.submit_failed(buffers, epilogue != VK_NULL_HANDLE);
  }
  return result;
}

}  // namespace

VkResult QueueSubmit(VkQueue queue, std::uint32_t count, const VkSubmitInfo* submits,
                     VkFence fence) {
  VkCommandBuffer kept = VK_NULL_HANDLE;
  const auto wrap = [&kept](VkCommandBuffer epilogue) {
    kept = epilogue;
    VkSubmitInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    info.commandBufferCount = 1;
    info.pCommandBuffers = &kept;
    return info;
  };
  return submit(queue, std::span(submits, count), wrap,
                [&](const DeviceTable& table, std::uint32_t number, const VkSubmitInfo* all) {
                  return table.QueueSubmit(queue, number, all, fence);
                });
}

VkResult QueueSubmit2(VkQueue queue, std::uint32_t count, const VkSubmitInfo2* submits,
                      VkFence fence) {
  VkCommandBufferSubmitInfo kept{};
  const auto wrap = [&kept](VkCommandBuffer epilogue) {
    kept.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO;
    kept.commandBuffer = epilogue;
    VkSubmitInfo2 info{};
    info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2;
    info.commandBufferInfoCount = 1;
    info.pCommandBufferInfos = &kept;
    return info;
  };
  return submit(queue, std::span(submits, count), wrap,
                [&](const DeviceTable& table, std::uint32_t number, const VkSubmitInfo2* all) {
                  return table.QueueSubmit2(queue, number, all, fence);
                });
}

}  // namespace a2rt::layer::entry
