#include "layer/lookup.h"

#include <array>
#include <cstring>
#include <string_view>

#include "layer/entry_points.h"
#include "layer/registry.h"

namespace a2rt::layer {
namespace {

struct Function {
  std::string_view name;
  PFN_vkVoidFunction pointer;
};

#define A2RT_FUNCTION(name) \
  Function{"vk" #name, reinterpret_cast<PFN_vkVoidFunction>(&entry::name)},

constexpr std::string_view kVendorSuffix = "KHR";

// A core function and its KHR original are one function under two names.
bool same_function(std::string_view listed, std::string_view asked) {
  if (listed == asked) {
    return true;
  }
  const bool longer = asked.size() == listed.size() + kVendorSuffix.size();
  const bool shorter = listed.size() == asked.size() + kVendorSuffix.size();
  return (longer && asked.starts_with(listed) && asked.ends_with(kVendorSuffix)) ||
         (shorter && listed.starts_with(asked) && listed.ends_with(kVendorSuffix));
}

template <class Functions>
PFN_vkVoidFunction find_in(const Functions& functions, std::string_view name) {
  for (const Function& function : functions) {
    if (same_function(function.name, name)) {
      return function.pointer;
    }
  }
  return nullptr;
}

}  // namespace

PFN_vkVoidFunction find_instance_function(const char* name) {
  static const std::array functions = {
      A2RT_FUNCTION(CreateInstance) A2RT_FUNCTION(DestroyInstance) A2RT_FUNCTION(CreateDevice)
          Function{"vkGetInstanceProcAddr",
                   reinterpret_cast<PFN_vkVoidFunction>(&get_instance_proc_addr)},
      Function{"vkGetDeviceProcAddr", reinterpret_cast<PFN_vkVoidFunction>(&get_device_proc_addr)}};
  return find_in(functions, name);
}

PFN_vkVoidFunction find_device_function(const char* name) {
  static const std::array functions = {A2RT_INTERCEPTED_DEVICE_FUNCTIONS(A2RT_FUNCTION)};
  return find_in(functions, name);
}

PFN_vkVoidFunction VKAPI_CALL get_instance_proc_addr(VkInstance instance, const char* name) {
  if (PFN_vkVoidFunction function = find_instance_function(name)) {
    return function;
  }
  if (instance == VK_NULL_HANDLE) {
    return nullptr;
  }
  const InstanceEntry entry = registry().instance(instance);
  return entry.table.GetInstanceProcAddr == nullptr
             ? nullptr
             : entry.table.GetInstanceProcAddr(instance, name);
}

PFN_vkVoidFunction VKAPI_CALL get_device_proc_addr(VkDevice device, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) {
    return reinterpret_cast<PFN_vkVoidFunction>(&get_device_proc_addr);
  }
  if (std::strcmp(name, "vkDestroyDevice") == 0) {
    return reinterpret_cast<PFN_vkVoidFunction>(&entry::DestroyDevice);
  }
  const DeviceEntry* known = registry().device(device);
  if (known == nullptr) {
    return nullptr;
  }
  const PFN_vkVoidFunction next = known->table.GetDeviceProcAddr(device, name);
  // A function that the driver lacks must stay missing.
  if (next == nullptr || known->active == nullptr) {
    return next;
  }
  const PFN_vkVoidFunction mine = find_device_function(name);
  return mine != nullptr ? mine : next;
}

}  // namespace a2rt::layer
