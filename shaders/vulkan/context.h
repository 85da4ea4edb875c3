// The Vulkan instance, device and queue, and the functions of the ray-tracing extensions.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <functional>
#include <string>

namespace a2rt::vulkan {

// Throws UserError naming the call and the result if it is a failure.
void check(VkResult result, const char* call);

struct RayTracingFunctions {
  PFN_vkCreateAccelerationStructureKHR create_acceleration_structure = nullptr;
  PFN_vkDestroyAccelerationStructureKHR destroy_acceleration_structure = nullptr;
  PFN_vkGetAccelerationStructureBuildSizesKHR build_sizes = nullptr;
  PFN_vkGetAccelerationStructureDeviceAddressKHR acceleration_structure_address = nullptr;
  PFN_vkCmdBuildAccelerationStructuresKHR cmd_build = nullptr;
  PFN_vkCreateRayTracingPipelinesKHR create_pipelines = nullptr;
  PFN_vkGetRayTracingShaderGroupHandlesKHR group_handles = nullptr;
  PFN_vkCmdTraceRaysKHR cmd_trace_rays = nullptr;
};

// One device with one queue. Buffers and images take a reference; it must outlive them.
class Context {
 public:
  // Picks lavapipe. Throws UserError that says which package or variable is missing.
  Context();
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  VkDevice device() const { return device_; }
  const RayTracingFunctions& rt() const { return rt_; }
  const std::string& device_name() const { return device_name_; }
  const std::string& driver_info() const { return driver_info_; }
  std::uint32_t max_recursion() const { return max_recursion_; }
  std::uint32_t group_handle_size() const { return group_handle_size_; }
  std::uint32_t group_base_alignment() const { return group_base_alignment_; }
  std::uint32_t memory_type(std::uint32_t allowed, VkMemoryPropertyFlags wanted) const;

  // Records with `record`, submits and waits.
  void run(const std::function<void(VkCommandBuffer)>& record) const;

 private:
  void create_instance();
  void pick_device();
  void create_device();
  void release();

  VkInstance instance_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  std::uint32_t family_ = 0;
  RayTracingFunctions rt_;
  std::string device_name_, driver_info_;
  std::uint32_t max_recursion_ = 1, group_handle_size_ = 32, group_base_alignment_ = 64;
};

}  // namespace a2rt::vulkan
