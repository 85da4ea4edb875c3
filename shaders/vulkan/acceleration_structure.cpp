#include "vulkan/acceleration_structure.h"

#include <utility>

namespace a2rt::vulkan {
namespace {

constexpr VkBufferUsageFlags kInput =
    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;

VkAccelerationStructureGeometryKHR geometry_of(VkGeometryTypeKHR type, VkGeometryFlagsKHR flags) {
  VkAccelerationStructureGeometryKHR g{};
  g.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR;
  g.geometryType = type;
  g.flags = flags;
  return g;
}

}  // namespace

AccelerationStructure AccelerationStructure::of_triangles(
    const Context& context, std::span<const TriangleGeometry> geometries) {
  std::vector<VkAccelerationStructureGeometryKHR> infos;
  std::vector<std::uint32_t> counts;
  for (const TriangleGeometry& t : geometries) {
    // No duplicates: a verdict per triangle and ray, as an any-hit count would otherwise depend on
    // the driver's tree.
    auto g = geometry_of(VK_GEOMETRY_TYPE_TRIANGLES_KHR,
                         t.opaque ? VK_GEOMETRY_OPAQUE_BIT_KHR
                                  : VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR);
    auto& triangles = g.geometry.triangles;
    triangles.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR;
    triangles.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
    triangles.vertexData.deviceAddress = t.vertices;
    triangles.vertexStride = t.vertex_stride;
    triangles.maxVertex = t.vertex_count == 0 ? 0 : t.vertex_count - 1;
    triangles.indexType = VK_INDEX_TYPE_UINT32;
    triangles.indexData.deviceAddress = t.indices;
    infos.push_back(g);
    counts.push_back(t.triangle_count);
  }
  return {context, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, infos, counts};
}

AccelerationStructure AccelerationStructure::of_boxes(const Context& context,
                                                      const BoxGeometry& boxes) {
  auto g = geometry_of(VK_GEOMETRY_TYPE_AABBS_KHR, VK_GEOMETRY_OPAQUE_BIT_KHR);
  g.geometry.aabbs.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_AABBS_DATA_KHR;
  g.geometry.aabbs.data.deviceAddress = boxes.boxes;
  g.geometry.aabbs.stride = sizeof(VkAabbPositionsKHR);
  return {context, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, {&g, 1}, {&boxes.count, 1}};
}

AccelerationStructure AccelerationStructure::of_instances(
    const Context& context, std::span<const VkAccelerationStructureInstanceKHR> instances) {
  const Buffer input = Buffer::of(context, instances, kInput);
  auto g = geometry_of(VK_GEOMETRY_TYPE_INSTANCES_KHR, 0);
  g.geometry.instances.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR;
  g.geometry.instances.data.deviceAddress = input.address();
  const auto count = static_cast<std::uint32_t>(instances.size());
  return {context, VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, {&g, 1}, {&count, 1}};
}

AccelerationStructure::AccelerationStructure(
    const Context& context, VkAccelerationStructureTypeKHR type,
    std::span<const VkAccelerationStructureGeometryKHR> geometries,
    std::span<const std::uint32_t> primitive_counts)
    : context_(&context) {
  VkAccelerationStructureBuildGeometryInfoKHR build{};
  build.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR;
  build.type = type;
  build.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
  build.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  build.geometryCount = static_cast<std::uint32_t>(geometries.size());
  build.pGeometries = geometries.data();
  VkAccelerationStructureBuildSizesInfoKHR sizes{};
  sizes.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR;
  context.rt().build_sizes(context.device(), VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR,
                           &build, primitive_counts.data(), &sizes);
  storage_ = Buffer(context, sizes.accelerationStructureSize,
                    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR);
  VkAccelerationStructureCreateInfoKHR info{};
  info.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR;
  info.buffer = storage_.handle();
  info.size = sizes.accelerationStructureSize;
  info.type = type;
  check(context.rt().create_acceleration_structure(context.device(), &info, nullptr, &structure_),
        "vkCreateAccelerationStructureKHR");
  const Buffer scratch(context, sizes.buildScratchSize, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
  build.dstAccelerationStructure = structure_;
  build.scratchData.deviceAddress = scratch.address();
  std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges;
  for (const std::uint32_t count : primitive_counts) {
    ranges.push_back({count, 0, 0, 0});
  }
  context.run([&](VkCommandBuffer commands) {
    const VkAccelerationStructureBuildRangeInfoKHR* range = ranges.data();
    context.rt().cmd_build(commands, 1, &build, &range);
  });
}

AccelerationStructure::~AccelerationStructure() {
  if (context_ != nullptr) {
    context_->rt().destroy_acceleration_structure(context_->device(), structure_, nullptr);
  }
}

VkDeviceAddress AccelerationStructure::address() const {
  VkAccelerationStructureDeviceAddressInfoKHR info{};
  info.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR;
  info.accelerationStructure = structure_;
  return context_->rt().acceleration_structure_address(context_->device(), &info);
}

void AccelerationStructure::swap(AccelerationStructure& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(storage_, other.storage_);
  std::swap(structure_, other.structure_);
}

}  // namespace a2rt::vulkan
