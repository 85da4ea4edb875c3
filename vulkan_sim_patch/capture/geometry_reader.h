// Reads primitives from a program's build inputs, as lavapipe reads them.
//
// Device addresses are host addresses on lavapipe, so the inputs are read where they are. The
// caller makes sure that the build has been executed and its inputs are still in place.
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <cstdint>

namespace a2rt::layer {

// lavapipe adds firstVertex to the base address and to the index. A reader that follows the
// specification (kOnce) therefore differs from the driver's leaves where firstVertex is not 0.
enum class FirstVertex { kOnce, kTwice };

class TriangleReader {
 public:
  TriangleReader(const VkAccelerationStructureGeometryTrianglesDataKHR& data,
                 const VkAccelerationStructureBuildRangeInfoKHR& range, FirstVertex first_vertex);
  // False for vertex or index formats that lavapipe does not take.
  bool supported() const;
  // Nine floats: three vertices with the transform applied.
  std::array<float, 9> read(std::uint32_t primitive) const;

 private:
  std::uint64_t index(std::uint64_t position) const;

  VkAccelerationStructureGeometryTrianglesDataKHR data_;
  const std::byte* vertices_;
  const std::byte* indices_;
  std::uint64_t index_offset_;
  std::array<float, 12> transform_;
};

std::array<float, 6> read_aabb(const VkAccelerationStructureGeometryAabbsDataKHR& data,
                               const VkAccelerationStructureBuildRangeInfoKHR& range,
                               std::uint32_t primitive);

VkAccelerationStructureInstanceKHR read_instance(
    const VkAccelerationStructureGeometryInstancesDataKHR& data,
    const VkAccelerationStructureBuildRangeInfoKHR& range, std::uint32_t instance);

float half_to_float(std::uint16_t half);

}  // namespace a2rt::layer
