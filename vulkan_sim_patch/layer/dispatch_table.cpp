#include "layer/dispatch_table.h"

#include <string>

namespace a2rt::layer {
namespace {

// Extensions become core under a name without suffix; a program may have enabled either.
template <class GetFunction>
PFN_vkVoidFunction find(const GetFunction& get, std::string name) {
  if (PFN_vkVoidFunction function = get(name.c_str())) {
    return function;
  }
  const bool suffixed = name.size() > 3 && name.compare(name.size() - 3, 3, "KHR") == 0;
  name = suffixed ? name.substr(0, name.size() - 3) : name + "KHR";
  return get(name.c_str());
}

}  // namespace

InstanceTable load_instance_table(VkInstance instance, PFN_vkGetInstanceProcAddr next) {
  const auto get = [&](const char* name) { return next(instance, name); };
  InstanceTable table;
  table.GetInstanceProcAddr = next;
#define A2RT_LOAD(name) table.name = reinterpret_cast<PFN_vk##name>(find(get, "vk" #name));
  A2RT_INSTANCE_FUNCTIONS(A2RT_LOAD)
#undef A2RT_LOAD
  return table;
}

DeviceTable load_device_table(VkDevice device, PFN_vkGetDeviceProcAddr next) {
  const auto get = [&](const char* name) { return next(device, name); };
  DeviceTable table;
  table.GetDeviceProcAddr = next;
#define A2RT_LOAD(name) table.name = reinterpret_cast<PFN_vk##name>(find(get, "vk" #name));
  A2RT_DEVICE_FUNCTIONS(A2RT_LOAD)
#undef A2RT_LOAD
  return table;
}

}  // namespace a2rt::layer
