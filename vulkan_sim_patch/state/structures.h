// Acceleration structures of one device: where they are and which build they hold.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <unordered_map>

namespace a2rt::layer {

// What stands at a device address after the last build or copy.
struct BuiltStructure {
  std::uint64_t id = 0;         // AsBlock::id or AsCopyBlock::destination_id
  std::uint32_t depth = 0;      // levels of box nodes; 0 = unknown
  bool has_non_opaque = false;  // some geometry lacks VK_GEOMETRY_OPAQUE_BIT_KHR
};

class Structures {
 public:
  void created(VkAccelerationStructureKHR structure, VkDeviceAddress address);
  // The address where nothing that was built stands any more, if that is so now.
  std::optional<VkDeviceAddress> destroyed(VkAccelerationStructureKHR structure);
  VkDeviceAddress address(VkAccelerationStructureKHR structure) const;  // 0 = unknown

  std::uint64_t new_id();
  void built(VkDeviceAddress address, const BuiltStructure& what);
  std::optional<BuiltStructure> at(VkDeviceAddress address) const;
  // Whether any structure built so far has geometry that any-hit shaders are called for.
  bool any_non_opaque() const;

 private:
  mutable std::mutex mutex_;
  std::unordered_map<VkAccelerationStructureKHR, VkDeviceAddress> addresses_;
  std::unordered_map<VkDeviceAddress, BuiltStructure> contents_;
  std::uint64_t last_id_ = 0;
  bool any_non_opaque_ = false;
};

}  // namespace a2rt::layer
