// vkCreateDevice: decides whether the layer works on a device, and with what.
#include <vulkan/vk_layer.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "layer/entry_points.h"
#include "layer/feature_chain.h"
#include "layer/log.h"
#include "layer/registry.h"

namespace a2rt::layer::entry {
namespace {

VkLayerDeviceCreateInfo* find_link(const VkDeviceCreateInfo* info) {
  auto* item = static_cast<const VkLayerDeviceCreateInfo*>(info->pNext);
  while (item != nullptr && (item->sType != VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO ||
                             item->function != VK_LAYER_LINK_INFO)) {
    item = static_cast<const VkLayerDeviceCreateInfo*>(item->pNext);
  }
  return const_cast<VkLayerDeviceCreateInfo*>(item);
}

std::vector<std::string> extensions_of(const VkDeviceCreateInfo* info) {
  return {info->ppEnabledExtensionNames,
          info->ppEnabledExtensionNames + info->enabledExtensionCount};
}

bool has(const std::vector<std::string>& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

DriverDescription describe_driver(const InstanceTable& table, VkPhysicalDevice physical) {
  DriverDescription out;
  VkPhysicalDeviceDriverProperties driver{};
  driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
  VkPhysicalDeviceProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  properties.pNext = &driver;
  if (table.GetPhysicalDeviceProperties2 != nullptr) {
    table.GetPhysicalDeviceProperties2(physical, &properties);
  }
  out.properties = properties.properties;
  out.driver_id = static_cast<std::uint32_t>(driver.driverID);
  out.driver_name = driver.driverName;
  out.driver_info = driver.driverInfo;
  return out;
}

// Says which ways of this device's program the capture cannot follow.
void refuse_extensions(Device& device, const std::vector<std::string>& extensions) {
  struct Unfollowed {
    std::string_view extension;
    const char* what;
  };
  constexpr Unfollowed kUnfollowed[] = {
      {"VK_EXT_descriptor_buffer", "structures in descriptor buffers are not known to the capture"},
      {"VK_EXT_shader_object", "shader objects that trace rays are not captured"},
      {"VK_EXT_device_generated_commands", "device-generated work that traces is not captured"}};
  for (const Unfollowed& one : kUnfollowed) {
    if (has(extensions, one.extension) && device.session() != nullptr) {
      device.refuse_once("the program enables " + std::string(one.extension) + ": " + one.what);
    }
  }
}

// Why the layer leaves a device alone; empty if it works on it. Unusual reasons are logged.
std::string reason_to_leave(const DriverDescription& driver, const Settings& settings,
                            const std::vector<std::string>& extensions) {
  if (!has(extensions, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME)) {
    return "it is created without " VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME;
  }
  const std::uint32_t id = settings.assumed_driver.value_or(driver.driver_id);
  if (id != VK_DRIVER_ID_MESA_LLVMPIPE) {
    return "its driver is not lavapipe but \"" + driver.driver_name + "\" (driver id " +
           std::to_string(id) + "); to use lavapipe, set VK_ICD_FILENAMES to its lvp_icd JSON file";
  }
  return {};
}

Settings settings_of_process() {
  std::vector<std::string> problems;
  Settings settings = read_settings_of_process(problems);
  set_log_level(settings.log_level);
  for (const std::string& problem : problems) {
    warn(problem);
  }
  return settings;
}

// Takes from the settings what belongs to another device or process.
void make_way(DeviceSetup& setup) {
  std::string& folder = setup.settings.capture_directory;
  if (setup.settings.instrumenting() && registry().has_session()) {
    warn("a second device at the same time is neither captured nor given verdicts");
    folder.clear();
    setup.settings.verdict_file.clear();
  }
  if (!folder.empty() && registry().has_captured()) {
    warn("this device is not captured: " + folder +
         " holds the capture of an earlier device of this program");
    folder.clear();
  }
  if (folder.empty()) {
    return;
  }
  setup.lock = std::make_shared<const CaptureLock>(folder);
  if (setup.lock->is_taken()) {
    warn("this process is not captured: " + folder +
         " belongs to another process that captures into it now; set A2RT_CAPTURE to another "
         "directory for one of them");
    folder.clear();
  }
}

std::unique_ptr<Device> activate(const DeviceSetup& setup) {
  auto device = std::make_unique<Device>(setup);
  refuse_extensions(*device, setup.extensions);
  return device;
}

}  // namespace

VkResult CreateDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                      const VkAllocationCallbacks* allocator, VkDevice* device) {
  VkLayerDeviceCreateInfo* link = find_link(info);
  if (link == nullptr) {
    return VK_ERROR_INITIALIZATION_FAILED;
  }
  const PFN_vkGetInstanceProcAddr next_instance = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  const PFN_vkGetDeviceProcAddr next_device = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const InstanceEntry instance = registry().instance(physical);
  const auto create =
      reinterpret_cast<PFN_vkCreateDevice>(next_instance(instance.instance, "vkCreateDevice"));
  if (create == nullptr) {
    return VK_ERROR_INITIALIZATION_FAILED;
  }

  DeviceSetup setup;
  setup.settings = settings_of_process();
  setup.extensions = extensions_of(info);
  setup.driver = describe_driver(instance.table, physical);
  const std::string leave = reason_to_leave(setup.driver, setup.settings, setup.extensions);
  if (!leave.empty()) {
    warn("this device runs untouched: " + leave);
    const VkResult result = create(physical, info, allocator, device);
    if (result == VK_SUCCESS) {
      registry().add(*device, {load_device_table(*device, next_device), nullptr});
    }
    return result;
  }
  make_way(setup);
  std::optional<FeatureChain> features;
  if (setup.settings.instrumenting()) {
    features.emplace(*info);
  }
  const VkResult result = create(physical, features ? features->info() : info, allocator, device);
  if (result != VK_SUCCESS) {
    return result;
  }
  setup.device = *device;
  setup.table = load_device_table(*device, next_device);
  setup.queue_family =
      info->queueCreateInfoCount != 0 ? info->pQueueCreateInfos[0].queueFamilyIndex : 0;
  instance.table.GetPhysicalDeviceMemoryProperties(physical, &setup.memory);
  try {
    registry().add(*device, {setup.table, activate(setup)});
  } catch (const std::exception& error) {
    // Running on without what was asked for would look like success.
    warn(std::string(error.what()) + "; the device is not created");
    setup.table.DestroyDevice(*device, allocator);
    *device = VK_NULL_HANDLE;
    return VK_ERROR_INITIALIZATION_FAILED;
  }
  return result;
}

void DestroyDevice(VkDevice device, const VkAllocationCallbacks* allocator) {
  if (device == VK_NULL_HANDLE) {
    return;
  }
  DeviceEntry entry = registry().take(device);
  if (entry.active != nullptr) {
    entry.active->finish(false);
    if (entry.active->has_capture()) {
      registry().remember_capture();
    }
    entry.active.reset();
  }
  entry.table.DestroyDevice(device, allocator);
}

}  // namespace a2rt::layer::entry
