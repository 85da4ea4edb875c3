// Runs host code at a point inside a command buffer.
//
// The command buffer writes the callback's number into a mailbox, sets event A and waits for event
// B; a thread of the layer sees A, runs the callback and sets B. lavapipe executes one command at a
// time and spins on B, so the callback stands exactly between the commands around it. Both events
// are reset by their reader, hence a command buffer may be submitted any number of times.
#pragma once

#include <vulkan/vulkan.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <unordered_map>

#include "layer/dispatch_table.h"

namespace a2rt::layer {

class HostCallbacks {
 public:
  using Callback = std::function<void()>;

  // Throws std::runtime_error if the driver refuses the events or the mailbox.
  HostCallbacks(const DeviceTable& table, VkDevice device,
                const VkPhysicalDeviceMemoryProperties& memory);
  // The device must still exist.
  ~HostCallbacks();
  HostCallbacks(const HostCallbacks&) = delete;
  HostCallbacks& operator=(const HostCallbacks&) = delete;

  // Registers a callback; it runs each time the commands of record() execute, until remove().
  std::uint64_t add(Callback callback);
  void remove(std::uint64_t id);
  // Records the commands. Not inside a render pass.
  void record(VkCommandBuffer commands, std::uint64_t id) const;

  // Tells how many callbacks a submit will run, before it is submitted.
  void expect(std::uint64_t count);
  // The submit failed, or a callback has run.
  void unexpect(std::uint64_t count);
  std::uint64_t pending() const;

  // Ends the thread; a callback that a command buffer still waits for is left waiting.
  void stop();

 private:
  void run();
  bool serve_one();

  const DeviceTable& table_;
  VkDevice device_;
  VkEvent asks_ = VK_NULL_HANDLE;     // A: the command buffer asks
  VkEvent answers_ = VK_NULL_HANDLE;  // B: the host is done
  VkBuffer mailbox_buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory mailbox_memory_ = VK_NULL_HANDLE;
  std::uint64_t* mailbox_ = nullptr;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::unordered_map<std::uint64_t, std::shared_ptr<const Callback>> callbacks_;
  std::uint64_t last_id_ = 0;
  std::uint64_t pending_ = 0;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace a2rt::layer
