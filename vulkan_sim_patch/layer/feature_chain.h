// The create info of a device, with the features that the rewritten shaders need switched on.
#pragma once

#include <vulkan/vulkan.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace a2rt::layer {

// The program's structures are only read: they may be constant data, and another thread may create
// a device from the same ones. Those that must change, and those that point to them, are copied.
class FeatureChain {
 public:
  explicit FeatureChain(const VkDeviceCreateInfo& program);
  FeatureChain(const FeatureChain&) = delete;
  FeatureChain& operator=(const FeatureChain&) = delete;
  // Valid as long as the program's create info and this object are.
  const VkDeviceCreateInfo* info() const { return &info_; }

 private:
  void copy_until(const void* end);
  void put_in_front(const VkBaseInStructure& original, std::size_t bytes);
  VkBaseOutStructure* copy_of(const VkBaseInStructure& original, std::size_t bytes);

  VkDeviceCreateInfo info_;
  VkPhysicalDeviceFeatures features_{};
  VkPhysicalDeviceBufferDeviceAddressFeatures addresses_{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES, nullptr, VK_TRUE, VK_FALSE,
      VK_FALSE};
  std::vector<std::unique_ptr<std::byte[]>> copies_;
};

}  // namespace a2rt::layer
