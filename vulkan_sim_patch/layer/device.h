// One device that the layer works on: settings, trackers, capture, host callbacks.
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capture/capture_lock.h"
#include "capture/session.h"
#include "capture/structure_writer.h"
#include "layer/dispatch_table.h"
#include "layer/host_callback.h"
#include "layer/settings.h"
#include "state/command_buffers.h"
#include "state/descriptors.h"
#include "state/shaders.h"
#include "state/structures.h"

namespace a2rt::layer {

struct DriverDescription {
  VkPhysicalDeviceProperties properties{};
  std::uint32_t driver_id = 0;
  std::string driver_name;
  std::string driver_info;
};

struct DeviceSetup {
  VkDevice device = VK_NULL_HANDLE;
  DeviceTable table;
  Settings settings;
  DriverDescription driver;
  VkPhysicalDeviceMemoryProperties memory{};
  std::uint32_t queue_family = 0;
  std::vector<std::string> extensions;
  std::shared_ptr<const CaptureLock> lock;  // of the capture's folder; null without capture
};

class Device {
 public:
  using Extent = std::array<std::uint32_t, 3>;

  // Throws std::runtime_error if a capture was asked for and cannot be made.
  explicit Device(const DeviceSetup& setup);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceTable& table() const { return setup_.table; }
  VkDevice handle() const { return setup_.device; }
  Structures& structures() { return structures_; }
  Descriptors& descriptors() { return descriptors_; }
  Shaders& shaders() { return shaders_; }
  CommandBuffers& commands() { return commands_; }
  StructureWriter& structure_writer() { return structure_writer_; }
  // Null if neither capture nor verdicts were asked for.
  Session* session() { return session_.get(); }
  ManifestWriter* manifest() { return session_ ? session_->manifest() : nullptr; }
  // Whether anything needs host code at builds.
  bool watches_builds() const { return session_ != nullptr || setup_.settings.rebuild; }

  // Says that the program does something the capture lacks; each text is said once.
  void refuse_once(const std::string& what);

  // A module as the driver gets it. `state` is null if it traces no rays or stays as it was.
  struct Module {
    std::vector<std::uint32_t> words;
    std::shared_ptr<const ModuleState> state;
  };
  Module instrument(std::span<const std::uint32_t> words);
  // The same module for a pipeline in which early fragment tests would show.
  std::vector<std::uint32_t> instrument_late(const ModuleState& module) const;
  // Writes the manifest blocks of a pipeline.
  void announce(const PipelineState& pipeline);

  // Records a host callback that lives as long as the recording of `commands`.
  void add_callback(VkCommandBuffer commands, HostCallbacks::Callback callback);
  void forget_callbacks(const std::vector<std::uint64_t>& ids);

  // Called from a host callback, right before the work executes.
  void begin_work(PipelineState::Kind kind, Extent size, std::span<const BoundWork> works);

  // What a submit will run; returns the command buffer that the layer appends to it so that the
  // capture is whole when the program's fence is signalled, or null if it needs none.
  VkCommandBuffer before_submit(std::span<const VkCommandBuffer> buffers);
  void submit_failed(std::span<const VkCommandBuffer> buffers, bool appended);

  // Ends the capture; `exiting` if the process ends without vkDestroyDevice.
  void finish(bool exiting);
  // Whether finish() has left a whole capture.
  bool has_capture() const { return session_ != nullptr && session_->complete(); }

 private:
  struct SubmitCount {
    std::uint64_t callbacks = 0;
    std::uint64_t traced = 0;
  };
  SubmitCount count(std::span<const VkCommandBuffer> buffers);
  void write_driver_block();
  void create_epilogue();
  std::uint32_t next_frame();
  std::vector<capture::SiteBinding> resolve_sites(std::span<const BoundWork> works);
  std::uint64_t resolve(const spirv::StructureSource& source, const BoundSets& sets) const;
  void warn_about_order(std::span<const BoundWork> works);
  void dump(std::span<const std::uint32_t> words, std::uint32_t shader, const char* suffix) const;

  DeviceSetup setup_;
  Structures structures_;
  Descriptors descriptors_;
  Shaders shaders_;
  CommandBuffers commands_;
  std::unique_ptr<Session> session_;
  std::unique_ptr<HostCallbacks> callbacks_;
  StructureWriter structure_writer_;
  std::mutex instrument_mutex_;

  VkCommandPool epilogue_pool_ = VK_NULL_HANDLE;
  VkCommandBuffer epilogue_ = VK_NULL_HANDLE;

  std::mutex mutex_;  // guards the members below
  std::vector<std::string> refused_;
  std::deque<std::uint64_t> frames_ahead_;  // traced work left in each submit, oldest first
  std::uint32_t frame_ = 0;
  bool order_warned_ = false;
};

// The device of a handle that the layer works on. Precondition: such a device exists.
Device& device_of(VkDevice device);
Device& device_of(VkQueue queue);
Device& device_of(VkCommandBuffer buffer);

}  // namespace a2rt::layer
