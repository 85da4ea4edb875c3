#include "layer/host_callback.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <thread>

namespace a2rt::layer {
namespace {

// A driver of two events and one word of memory. The second event made is the layer's answer.
struct FakeDriver {
  std::atomic<bool> set[2] = {false, false};
  int events = 0;
  std::uint64_t mailbox = 0;
  const HostCallbacks* callbacks = nullptr;
  std::atomic<std::uint64_t> pending_at_answer = 99;
};
FakeDriver* driver = nullptr;

std::atomic<bool>& state_of(VkEvent event) {
  return driver->set[reinterpret_cast<std::uintptr_t>(event) - 1];
}

DeviceTable fake_table() {
  DeviceTable table;
  table.CreateEvent = [](VkDevice, const VkEventCreateInfo*, const VkAllocationCallbacks*,
                         VkEvent* event) {
    *event = reinterpret_cast<VkEvent>(static_cast<std::uintptr_t>(++driver->events));
    return VK_SUCCESS;
  };
  table.GetEventStatus = [](VkDevice, VkEvent event) {
    return state_of(event).load() ? VK_EVENT_SET : VK_EVENT_RESET;
  };
  table.ResetEvent = [](VkDevice, VkEvent event) {
    state_of(event) = false;
    return VK_SUCCESS;
  };
  table.SetEvent = [](VkDevice, VkEvent event) {
    driver->pending_at_answer = driver->callbacks->pending();
    state_of(event) = true;
    return VK_SUCCESS;
  };
  table.DestroyEvent = [](VkDevice, VkEvent, const VkAllocationCallbacks*) {};
  table.CreateBuffer = [](VkDevice, const VkBufferCreateInfo*, const VkAllocationCallbacks*,
                          VkBuffer*) { return VK_SUCCESS; };
  table.DestroyBuffer = [](VkDevice, VkBuffer, const VkAllocationCallbacks*) {};
  table.GetBufferMemoryRequirements = [](VkDevice, VkBuffer, VkMemoryRequirements* needs) {
    *needs = {sizeof(std::uint64_t), 8, 1};
  };
  table.AllocateMemory = [](VkDevice, const VkMemoryAllocateInfo*, const VkAllocationCallbacks*,
                            VkDeviceMemory*) { return VK_SUCCESS; };
  table.FreeMemory = [](VkDevice, VkDeviceMemory, const VkAllocationCallbacks*) {};
  table.BindBufferMemory = [](VkDevice, VkBuffer, VkDeviceMemory, VkDeviceSize) {
    return VK_SUCCESS;
  };
  table.MapMemory = [](VkDevice, VkDeviceMemory, VkDeviceSize, VkDeviceSize, VkMemoryMapFlags,
                       void** mapped) {
    *mapped = &driver->mailbox;
    return VK_SUCCESS;
  };
  return table;
}

TEST(HostCallbacks, nothing_is_pending_once_the_last_answer_stands) {
  FakeDriver fake;
  driver = &fake;
  const DeviceTable table = fake_table();
  VkPhysicalDeviceMemoryProperties memory{};
  memory.memoryTypeCount = 1;
  memory.memoryTypes[0].propertyFlags =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  HostCallbacks callbacks(table, VK_NULL_HANDLE, memory);
  fake.callbacks = &callbacks;
  bool ran = false;
  fake.mailbox = callbacks.add([&ran] { ran = true; });
  callbacks.expect(1);
  fake.set[0] = true;
  while (!fake.set[1]) {
    std::this_thread::yield();
  }
  EXPECT_TRUE(ran);
  EXPECT_EQ(fake.pending_at_answer, 0u);
}

}  // namespace
}  // namespace a2rt::layer
