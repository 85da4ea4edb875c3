// Instances and devices of the process, by the loader's dispatch key.
#pragma once

#include <vulkan/vulkan.h>

#include <memory>
#include <shared_mutex>
#include <unordered_map>

#include "layer/device.h"
#include "layer/dispatch_table.h"

namespace a2rt::layer {

// The first word of a dispatchable handle; shared by an instance and its physical devices, and by
// a device, its queues and command buffers.
inline void* dispatch_key(const void* handle) { return *static_cast<void* const*>(handle); }

struct InstanceEntry {
  VkInstance instance = VK_NULL_HANDLE;
  InstanceTable table;
};

struct DeviceEntry {
  DeviceTable table;
  std::unique_ptr<Device> active;  // null: the device runs untouched
};

class Registry {
 public:
  // Ends the captures of devices that the program did not destroy.
  ~Registry();

  void add(VkInstance instance, InstanceTable table);
  void add(VkDevice device, DeviceEntry entry);
  InstanceEntry instance(const void* handle) const;
  // Null if the layer never saw the device.
  DeviceEntry* device(const void* handle) const;
  void remove(VkInstance instance);
  DeviceEntry take(VkDevice device);
  // Only one device of a process captures at a time.
  bool has_session() const;
  // And only one leaves a capture: a later one would replace it unseen.
  bool has_captured() const;
  void remember_capture();

 private:
  mutable std::shared_mutex mutex_;
  std::unordered_map<void*, InstanceEntry> instances_;
  std::unordered_map<void*, std::unique_ptr<DeviceEntry>> devices_;
  bool captured_ = false;
};

Registry& registry();

}  // namespace a2rt::layer
