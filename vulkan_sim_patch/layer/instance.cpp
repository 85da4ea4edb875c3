// Instances, and the registry of instances and devices.
#include <vulkan/vk_layer.h>

#include <mutex>
#include <utility>

#include "layer/entry_points.h"
#include "layer/registry.h"

namespace a2rt::layer {

Registry::~Registry() {
  for (auto& [key, entry] : devices_) {
    if (entry->active != nullptr) {
      entry->active->finish(true);
      // The driver may be gone by now; nothing of it may be destroyed any more.
      [[maybe_unused]] const Device* leaked = entry->active.release();
    }
  }
}

void Registry::add(VkInstance instance, InstanceTable table) {
  const std::unique_lock lock(mutex_);
  instances_[dispatch_key(instance)] = {instance, table};
}

void Registry::add(VkDevice device, DeviceEntry entry) {
  const std::unique_lock lock(mutex_);
  devices_[dispatch_key(device)] = std::make_unique<DeviceEntry>(std::move(entry));
}

InstanceEntry Registry::instance(const void* handle) const {
  const std::shared_lock lock(mutex_);
  const auto found = instances_.find(dispatch_key(handle));
  return found == instances_.end() ? InstanceEntry{} : found->second;
}

DeviceEntry* Registry::device(const void* handle) const {
  const std::shared_lock lock(mutex_);
  const auto found = devices_.find(dispatch_key(handle));
  return found == devices_.end() ? nullptr : found->second.get();
}

void Registry::remove(VkInstance instance) {
  const std::unique_lock lock(mutex_);
  instances_.erase(dispatch_key(instance));
}

DeviceEntry Registry::take(VkDevice device) {
  const std::unique_lock lock(mutex_);
  const auto found = devices_.find(dispatch_key(device));
  DeviceEntry entry;
  if (found != devices_.end()) {
    entry = std::move(*found->second);
    devices_.erase(found);
  }
  return entry;
}

bool Registry::has_session() const {
  const std::shared_lock lock(mutex_);
  for (const auto& [key, entry] : devices_) {
    if (entry->active != nullptr && entry->active->session() != nullptr) {
      return true;
    }
  }
  return false;
}

bool Registry::has_captured() const {
  const std::shared_lock lock(mutex_);
  return captured_;
}

void Registry::remember_capture() {
  const std::unique_lock lock(mutex_);
  captured_ = true;
}

Registry& registry() {
  static Registry instance;
  return instance;
}

Device& device_of(VkDevice device) { return *registry().device(device)->active; }
Device& device_of(VkQueue queue) { return *registry().device(queue)->active; }
Device& device_of(VkCommandBuffer buffer) { return *registry().device(buffer)->active; }

namespace entry {
namespace {

VkLayerInstanceCreateInfo* find_link(const VkInstanceCreateInfo* info) {
  auto* item = static_cast<const VkLayerInstanceCreateInfo*>(info->pNext);
  while (item != nullptr && (item->sType != VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO ||
                             item->function != VK_LAYER_LINK_INFO)) {
    item = static_cast<const VkLayerInstanceCreateInfo*>(item->pNext);
  }
  // The loader hands this structure over to be advanced.
  return const_cast<VkLayerInstanceCreateInfo*>(item);
}

}  // namespace

VkResult CreateInstance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                        VkInstance* instance) {
  VkLayerInstanceCreateInfo* link = find_link(info);
  if (link == nullptr) {
    return VK_ERROR_INITIALIZATION_FAILED;
  }
  const PFN_vkGetInstanceProcAddr next = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create =
      reinterpret_cast<PFN_vkCreateInstance>(next(VK_NULL_HANDLE, "vkCreateInstance"));
  if (create == nullptr) {
    return VK_ERROR_INITIALIZATION_FAILED;
  }
  const VkResult result = create(info, allocator, instance);
  if (result == VK_SUCCESS) {
    registry().add(*instance, load_instance_table(*instance, next));
  }
  return result;
}

void DestroyInstance(VkInstance instance, const VkAllocationCallbacks* allocator) {
  if (instance == VK_NULL_HANDLE) {
    return;
  }
  const InstanceEntry entry = registry().instance(instance);
  registry().remove(instance);
  entry.table.DestroyInstance(instance, allocator);
}

}  // namespace entry
}  // namespace a2rt::layer
