// What the layer remembers of each command buffer while it is recorded.
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "state/descriptors.h"
#include "state/shaders.h"

namespace a2rt::layer {

// A descriptor set as bound: a set, or descriptors pushed into the command buffer.
struct BoundSet {
  VkDescriptorSet set = VK_NULL_HANDLE;
  StructureDescriptors pushed;
};
using BoundSets = std::map<std::uint32_t, BoundSet>;

struct BindPoint {
  std::shared_ptr<const PipelineState> pipeline;
  BoundSets sets;
};

enum class BindPointKind : std::size_t { kGraphics = 0, kCompute = 1, kRayTracing = 2 };

// A draw or dispatch with what was bound: enough to say later which structures it traces.
struct BoundWork {
  std::shared_ptr<const PipelineState> pipeline;
  BoundSets sets;
};

// The draws of one render pass that may trace rays. It grows while the pass is recorded and is read
// when the pass executes.
struct DrawPass {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<BoundWork> draws;
};

struct CommandBufferState {
  VkCommandPool pool = VK_NULL_HANDLE;
  std::array<BindPoint, 3> points;
  std::vector<std::uint64_t> callbacks;  // registered for this command buffer alone
  std::uint64_t callback_count = 0;      // that one execution runs, secondaries included
  std::vector<std::shared_ptr<DrawPass>> passes;
  std::shared_ptr<DrawPass> open_pass;
  std::vector<BoundWork> inherited_draws;  // of a secondary that continues a render pass
  std::uint64_t dispatch_count = 0;        // traces and dispatches, secondaries included

  BindPoint& point(BindPointKind kind) { return points[static_cast<std::size_t>(kind)]; }
  // Executions of instrumented work in one execution of this command buffer.
  std::uint64_t traced_work() const;
};

class CommandBuffers {
 public:
  void allocated(VkCommandPool pool, const VkCommandBuffer* buffers, std::uint32_t count);
  // Each of these returns the callbacks that are no longer needed.
  std::vector<std::uint64_t> reset(VkCommandBuffer buffer);
  std::vector<std::uint64_t> freed(const VkCommandBuffer* buffers, std::uint32_t count);
  std::vector<std::uint64_t> pool_reset(VkCommandPool pool);
  std::vector<std::uint64_t> pool_destroyed(VkCommandPool pool);

  // Recording is externally synchronised by Vulkan, so the state is used without a lock.
  std::shared_ptr<CommandBufferState> find(VkCommandBuffer buffer);

 private:
  std::mutex mutex_;
  std::unordered_map<VkCommandBuffer, std::shared_ptr<CommandBufferState>> states_;
};

}  // namespace a2rt::layer
