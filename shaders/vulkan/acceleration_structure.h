// Bottom- and top-level acceleration structures.
#pragma once

#include <span>
#include <vector>

#include "vulkan/buffer.h"

namespace a2rt::vulkan {

// One geometry of a bottom-level structure, in buffers that live until the build is done.
struct TriangleGeometry {
  VkDeviceAddress vertices = 0;  // of the first vertex; positions come first in each
  VkDeviceSize vertex_stride = 0;
  std::uint32_t vertex_count = 0;
  VkDeviceAddress indices = 0;  // u32
  std::uint32_t triangle_count = 0;
  bool opaque = true;
};
struct BoxGeometry {
  VkDeviceAddress boxes = 0;  // VkAabbPositionsKHR
  std::uint32_t count = 0;
};

class AccelerationStructure {
 public:
  static AccelerationStructure of_triangles(const Context& context,
                                            std::span<const TriangleGeometry> geometries);
  static AccelerationStructure of_boxes(const Context& context, const BoxGeometry& boxes);
  static AccelerationStructure of_instances(
      const Context& context, std::span<const VkAccelerationStructureInstanceKHR> instances);

  AccelerationStructure() = default;
  AccelerationStructure(AccelerationStructure&& other) noexcept { swap(other); }
  AccelerationStructure& operator=(AccelerationStructure&& other) noexcept {
    swap(other);
    return *this;
  }
  ~AccelerationStructure();

  VkAccelerationStructureKHR handle() const { return structure_; }
  VkDeviceAddress address() const;
  VkDeviceSize bytes() const { return storage_.bytes(); }

 private:
  AccelerationStructure(const Context& context, VkAccelerationStructureTypeKHR type,
                        std::span<const VkAccelerationStructureGeometryKHR> geometries,
                        std::span<const std::uint32_t> primitive_counts);
  void swap(AccelerationStructure& other) noexcept;

  const Context* context_ = nullptr;
  Buffer storage_;
  VkAccelerationStructureKHR structure_ = VK_NULL_HANDLE;
};

}  // namespace a2rt::vulkan
