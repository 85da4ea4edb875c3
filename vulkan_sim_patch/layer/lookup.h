// Which functions the layer stands in for.
#pragma once

#include <vulkan/vulkan.h>

namespace a2rt::layer {

// Null if the layer does not intercept that function.
PFN_vkVoidFunction find_instance_function(const char* name);
PFN_vkVoidFunction find_device_function(const char* name);

PFN_vkVoidFunction VKAPI_CALL get_instance_proc_addr(VkInstance instance, const char* name);
PFN_vkVoidFunction VKAPI_CALL get_device_proc_addr(VkDevice device, const char* name);

}  // namespace a2rt::layer
