#include "vulkan/context.h"

#include <array>
#include <cstring>
#include <vector>

#include "a2rt/base/error.h"

namespace a2rt::vulkan {
namespace {

constexpr const char* kRemedy =
    "; install lavapipe with ray-tracing pipelines (Mesa 25 or newer): package "
    "mesa-vulkan-drivers, on Debian 12 from bookworm-backports "
    "(apt-get install -t bookworm-backports mesa-vulkan-drivers)";

constexpr std::array kDeviceExtensions = {VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                                          VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME,
                                          VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME};

bool has_extension(VkPhysicalDevice device, const char* name) {
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> all(count);
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, all.data());
  for (const VkExtensionProperties& e : all) {
    if (std::strcmp(e.extensionName, name) == 0) {
      return true;
    }
  }
  return false;
}

template <class Function>
void load(VkDevice device, const char* name, Function& function) {
  function = reinterpret_cast<Function>(vkGetDeviceProcAddr(device, name));
  if (function == nullptr) {
    throw UserError(std::string("the Vulkan driver has no ") + name + kRemedy);
  }
}

}  // namespace

void check(VkResult result, const char* call) {
  if (result < 0) {
    throw UserError(std::string(call) + " failed with Vulkan result " +
                    std::to_string(static_cast<int>(result)));
  }
}

Context::Context() {
  try {
    create_instance();
    pick_device();
    create_device();
  } catch (...) {
    release();
    throw;
  }
}

Context::~Context() { release(); }

void Context::release() {
  if (device_ != VK_NULL_HANDLE) {
    vkDeviceWaitIdle(device_);
    vkDestroyCommandPool(device_, pool_, nullptr);
    vkDestroyDevice(device_, nullptr);
  }
  if (instance_ != VK_NULL_HANDLE) {
    vkDestroyInstance(instance_, nullptr);
  }
}

void Context::create_instance() {
  VkApplicationInfo app{};
  app.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
  app.pApplicationName = "a2rt-render";
  app.apiVersion = VK_API_VERSION_1_2;
  VkInstanceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  info.pApplicationInfo = &app;
  const VkResult result = vkCreateInstance(&info, nullptr, &instance_);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER || result == VK_ERROR_LAYER_NOT_PRESENT) {
    throw UserError(std::string("no usable Vulkan driver") +
                    (result == VK_ERROR_LAYER_NOT_PRESENT
                         ? ": a layer named in VK_INSTANCE_LAYERS is not found (set VK_LAYER_PATH)"
                         : kRemedy));
  }
  check(result, "vkCreateInstance");
}

void Context::pick_device() {
  std::uint32_t count = 0;
  vkEnumeratePhysicalDevices(instance_, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  vkEnumeratePhysicalDevices(instance_, &count, devices.data());
  std::string seen;
  for (VkPhysicalDevice device : devices) {
    VkPhysicalDeviceDriverProperties driver{};
    driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
    VkPhysicalDeviceProperties2 properties{};
    properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
    properties.pNext = &driver;
    vkGetPhysicalDeviceProperties2(device, &properties);
    seen += (seen.empty() ? "" : ", ") + std::string(properties.properties.deviceName);
    if (driver.driverID == VK_DRIVER_ID_MESA_LLVMPIPE) {
      physical_ = device;
      device_name_ = properties.properties.deviceName;
      driver_info_ = driver.driverInfo;
      break;
    }
  }
  if (physical_ == VK_NULL_HANDLE) {
    throw UserError(
        "no lavapipe device among the Vulkan devices (" + (seen.empty() ? "none" : seen) +
        "); if VK_ICD_FILENAMES or VK_DRIVER_FILES is set, it must name lvp_icd*.json" + kRemedy);
  }
  for (const char* extension : kDeviceExtensions) {
    if (!has_extension(physical_, extension)) {
      throw UserError(device_name_ + " (" + driver_info_ + ") lacks " + extension + kRemedy);
    }
  }
}

void Context::create_device() {
  VkPhysicalDeviceRayTracingPipelinePropertiesKHR rt{};
  rt.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR;
  VkPhysicalDeviceProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  properties.pNext = &rt;
  vkGetPhysicalDeviceProperties2(physical_, &properties);
  max_recursion_ = rt.maxRayRecursionDepth;
  group_handle_size_ = rt.shaderGroupHandleSize;
  group_base_alignment_ = rt.shaderGroupBaseAlignment;

  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, families.data());
  while (family_ < count && (families[family_].queueFlags & VK_QUEUE_COMPUTE_BIT) == 0) {
    ++family_;
  }
  A2RT_CHECK(family_ < count, "the device has no compute queue");

  VkPhysicalDeviceAccelerationStructureFeaturesKHR as_features{};
  as_features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR;
  as_features.accelerationStructure = VK_TRUE;
  VkPhysicalDeviceRayTracingPipelineFeaturesKHR rt_features{};
  rt_features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR;
  rt_features.pNext = &as_features;
  rt_features.rayTracingPipeline = VK_TRUE;
  VkPhysicalDeviceVulkan12Features features12{};
  features12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
  features12.pNext = &rt_features;
  features12.bufferDeviceAddress = VK_TRUE;
  features12.scalarBlockLayout = VK_TRUE;
  features12.runtimeDescriptorArray = VK_TRUE;
  features12.shaderSampledImageArrayNonUniformIndexing = VK_TRUE;

  const float priority = 1;
  VkDeviceQueueCreateInfo queue{};
  queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queue.queueFamilyIndex = family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkDeviceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  info.pNext = &features12;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.enabledExtensionCount = static_cast<std::uint32_t>(kDeviceExtensions.size());
  info.ppEnabledExtensionNames = kDeviceExtensions.data();
  check(vkCreateDevice(physical_, &info, nullptr, &device_), "vkCreateDevice");
  vkGetDeviceQueue(device_, family_, 0, &queue_);

  load(device_, "vkCreateAccelerationStructureKHR", rt_.create_acceleration_structure);
  load(device_, "vkDestroyAccelerationStructureKHR", rt_.destroy_acceleration_structure);
  load(device_, "vkGetAccelerationStructureBuildSizesKHR", rt_.build_sizes);
  load(device_, "vkGetAccelerationStructureDeviceAddressKHR", rt_.acceleration_structure_address);
  load(device_, "vkCmdBuildAccelerationStructuresKHR", rt_.cmd_build);
  load(device_, "vkCreateRayTracingPipelinesKHR", rt_.create_pipelines);
  load(device_, "vkGetRayTracingShaderGroupHandlesKHR", rt_.group_handles);
  load(device_, "vkCmdTraceRaysKHR", rt_.cmd_trace_rays);

  VkCommandPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
  pool.queueFamilyIndex = family_;
  check(vkCreateCommandPool(device_, &pool, nullptr, &pool_), "vkCreateCommandPool");
}

std::uint32_t Context::memory_type(std::uint32_t allowed, VkMemoryPropertyFlags wanted) const {
  VkPhysicalDeviceMemoryProperties memory{};
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory);
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    if ((allowed & (1U << i)) != 0 && (memory.memoryTypes[i].propertyFlags & wanted) == wanted) {
      return i;
    }
  }
  throw UserError("the Vulkan device has no memory that the host can map" + std::string(kRemedy));
}

void Context::run(const std::function<void(VkCommandBuffer)>& record) const {
  VkCommandBufferAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  allocate.commandPool = pool_;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  check(vkAllocateCommandBuffers(device_, &allocate, &commands), "vkAllocateCommandBuffers");
  VkCommandBufferBeginInfo begin{};
  begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
  record(commands);
  check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
  VkSubmitInfo submit{};
  submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands;
  check(vkQueueSubmit(queue_, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit");
  check(vkQueueWaitIdle(queue_), "vkQueueWaitIdle");
  vkFreeCommandBuffers(device_, pool_, 1, &commands);
}

}  // namespace a2rt::vulkan
