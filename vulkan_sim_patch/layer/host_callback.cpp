#include "layer/host_callback.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>

#include "layer/log.h"

namespace a2rt::layer {
namespace {

using Clock = std::chrono::steady_clock;

// A wait costs at most this share of itself in delay. Polling at one short interval took seconds
// from the driver's threads while they compiled shaders.
constexpr int kDelayShare = 32;
constexpr std::chrono::nanoseconds kShortestPoll = std::chrono::microseconds(30);
constexpr std::chrono::nanoseconds kLongestPoll = std::chrono::milliseconds(2);

void check(VkResult result, const char* what) {
  if (result != VK_SUCCESS) {
    throw std::runtime_error(std::string("the driver refused ") + what + " (VkResult " +
                             std::to_string(result) + ")");
  }
}

std::uint32_t host_memory_type(const VkPhysicalDeviceMemoryProperties& memory,
                               std::uint32_t allowed) {
  constexpr VkMemoryPropertyFlags kWanted =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    if ((allowed >> i & 1u) != 0 && (memory.memoryTypes[i].propertyFlags & kWanted) == kWanted) {
      return i;
    }
  }
  throw std::runtime_error("the driver has no host-visible memory");
}

}  // namespace

HostCallbacks::HostCallbacks(const DeviceTable& table, VkDevice device,
                             const VkPhysicalDeviceMemoryProperties& memory)
    : table_(table), device_(device) {
  VkEventCreateInfo event{};
  event.sType = VK_STRUCTURE_TYPE_EVENT_CREATE_INFO;
  check(table_.CreateEvent(device_, &event, nullptr, &asks_), "an event");
  check(table_.CreateEvent(device_, &event, nullptr, &answers_), "an event");
  VkBufferCreateInfo buffer{};
  buffer.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  buffer.size = sizeof(std::uint64_t);
  buffer.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  check(table_.CreateBuffer(device_, &buffer, nullptr, &mailbox_buffer_), "a buffer");
  VkMemoryRequirements needs{};
  table_.GetBufferMemoryRequirements(device_, mailbox_buffer_, &needs);
  VkMemoryAllocateInfo allocation{};
  allocation.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  allocation.allocationSize = needs.size;
  allocation.memoryTypeIndex = host_memory_type(memory, needs.memoryTypeBits);
  check(table_.AllocateMemory(device_, &allocation, nullptr, &mailbox_memory_), "memory");
  check(table_.BindBufferMemory(device_, mailbox_buffer_, mailbox_memory_, 0), "a binding");
  void* mapped = nullptr;
  check(table_.MapMemory(device_, mailbox_memory_, 0, VK_WHOLE_SIZE, 0, &mapped), "a mapping");
  mailbox_ = static_cast<std::uint64_t*>(mapped);
  thread_ = std::thread([this] { run(); });
}

HostCallbacks::~HostCallbacks() {
  stop();
  table_.DestroyEvent(device_, asks_, nullptr);
  table_.DestroyEvent(device_, answers_, nullptr);
  table_.DestroyBuffer(device_, mailbox_buffer_, nullptr);
  table_.FreeMemory(device_, mailbox_memory_, nullptr);
}

void HostCallbacks::stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
}

std::uint64_t HostCallbacks::add(Callback callback) {
  const std::lock_guard lock(mutex_);
  callbacks_[++last_id_] = std::make_shared<const Callback>(std::move(callback));
  return last_id_;
}

void HostCallbacks::remove(std::uint64_t id) {
  const std::lock_guard lock(mutex_);
  callbacks_.erase(id);
}

void HostCallbacks::record(VkCommandBuffer commands, std::uint64_t id) const {
  const VkMemoryBarrier all{VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr, VK_ACCESS_MEMORY_WRITE_BIT,
                            VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT};
  const auto barrier = [&] {
    table_.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                              VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                              &all, 0, nullptr, 0, nullptr);
  };
  barrier();
  table_.CmdUpdateBuffer(commands, mailbox_buffer_, 0, sizeof(id), &id);
  barrier();
  table_.CmdSetEvent(commands, asks_, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT);
  table_.CmdWaitEvents(commands, 1, &answers_, VK_PIPELINE_STAGE_HOST_BIT,
                       VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 1, &all, 0, nullptr, 0, nullptr);
  table_.CmdResetEvent(commands, answers_, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT);
  barrier();
}

void HostCallbacks::expect(std::uint64_t count) {
  {
    const std::lock_guard lock(mutex_);
    pending_ += count;
  }
  wake_.notify_all();
}

void HostCallbacks::unexpect(std::uint64_t count) {
  const std::lock_guard lock(mutex_);
  pending_ -= count;
}

std::uint64_t HostCallbacks::pending() const {
  const std::lock_guard lock(mutex_);
  return pending_;
}

void HostCallbacks::run() {
  std::unique_lock lock(mutex_);
  Clock::time_point waiting_since = Clock::now();
  while (!stop_) {
    if (pending_ == 0) {
      wake_.wait(lock);
      waiting_since = Clock::now();
      continue;
    }
    lock.unlock();
    const bool served = serve_one();
    if (served) {
      waiting_since = Clock::now();
    } else {
      std::this_thread::sleep_for(std::clamp<std::chrono::nanoseconds>(
          (Clock::now() - waiting_since) / kDelayShare, kShortestPoll, kLongestPoll));
    }
    lock.lock();
  }
}

bool HostCallbacks::serve_one() {
  if (table_.GetEventStatus(device_, asks_) != VK_EVENT_SET) {
    return false;
  }
  table_.ResetEvent(device_, asks_);
  const std::uint64_t id = std::atomic_ref(*mailbox_).load(std::memory_order_acquire);
  std::shared_ptr<const Callback> callback;
  {
    const std::lock_guard lock(mutex_);
    const auto found = callbacks_.find(id);
    if (found != callbacks_.end()) {
      callback = found->second;
    }
  }
  try {
    if (callback != nullptr) {
      (*callback)();
    } else {
      warn("a command buffer asks for callback " + std::to_string(id) +
           ", which is gone: the program frees command buffers that still run");
    }
  } catch (const std::exception& error) {
    warn(error.what());
  }
  // The program may destroy the device as soon as the answer stands: by then nothing may look as
  // if it still ran.
  unexpect(1);
  table_.SetEvent(device_, answers_);
  return true;
}

}  // namespace a2rt::layer
