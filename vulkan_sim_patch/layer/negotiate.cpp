// The only exported function: the loader's way in.
#include <vulkan/vk_layer.h>

#include <cstdint>

#include "layer/lookup.h"

extern "C" __attribute__((visibility("default"))) VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* interface) {
  constexpr std::uint32_t kInterfaceVersion = 2;
  if (interface == nullptr || interface->sType != LAYER_NEGOTIATE_INTERFACE_STRUCT ||
      interface->loaderLayerInterfaceVersion < kInterfaceVersion) {
    return VK_ERROR_INITIALIZATION_FAILED;
  }
  interface->loaderLayerInterfaceVersion = kInterfaceVersion;
  interface->pfnGetInstanceProcAddr = a2rt::layer::get_instance_proc_addr;
  interface->pfnGetDeviceProcAddr = a2rt::layer::get_device_proc_addr;
  interface->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}
