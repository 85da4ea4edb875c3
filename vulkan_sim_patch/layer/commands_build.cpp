// Acceleration structures: creation, builds, copies.
#include <memory>
#include <string>

#include "layer/device.h"
#include "layer/entry_points.h"

namespace a2rt::layer::entry {
namespace {

StructureBuild copy_build(const VkAccelerationStructureBuildGeometryInfoKHR& info,
                          const VkAccelerationStructureBuildRangeInfoKHR* ranges) {
  StructureBuild build;
  build.target = info.dstAccelerationStructure;
  build.type = info.type;
  build.flags = info.flags;
  build.is_update = info.mode == VK_BUILD_ACCELERATION_STRUCTURE_MODE_UPDATE_KHR;
  for (std::uint32_t i = 0; i < info.geometryCount; ++i) {
    build.geometries.push_back(info.pGeometries != nullptr ? info.pGeometries[i]
                                                           : *info.ppGeometries[i]);
    // Extension structures of the program need not live until the build executes.
    build.geometries.back().pNext = nullptr;
    build.geometries.back().geometry.triangles.pNext = nullptr;
    build.ranges.push_back(ranges[i]);
  }
  if (build.type == VK_ACCELERATION_STRUCTURE_TYPE_GENERIC_KHR && !build.geometries.empty()) {
    build.type = build.geometries[0].geometryType == VK_GEOMETRY_TYPE_INSTANCES_KHR
                     ? VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR
                     : VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR;
  }
  return build;
}

}  // namespace

VkResult CreateAccelerationStructureKHR(VkDevice handle,
                                        const VkAccelerationStructureCreateInfoKHR* info,
                                        const VkAllocationCallbacks* allocator,
                                        VkAccelerationStructureKHR* structure) {
  Device& device = device_of(handle);
  const VkResult result =
      device.table().CreateAccelerationStructureKHR(handle, info, allocator, structure);
  if (result == VK_SUCCESS) {
    const VkAccelerationStructureDeviceAddressInfoKHR query{
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR, nullptr, *structure};
    device.structures().created(
        *structure, device.table().GetAccelerationStructureDeviceAddressKHR(handle, &query));
  }
  return result;
}

void DestroyAccelerationStructureKHR(VkDevice handle, VkAccelerationStructureKHR structure,
                                     const VkAllocationCallbacks* allocator) {
  Device& device = device_of(handle);
  const auto gone = device.structures().destroyed(structure);
  if (gone && device.manifest() != nullptr) {
    const capture::AsDestroyedBlock block{*gone};
    device.manifest()->write(capture::BlockType::kAsDestroyed, {bytes_of(block)});
  }
  device.table().DestroyAccelerationStructureKHR(handle, structure, allocator);
}

void CmdBuildAccelerationStructuresKHR(
    VkCommandBuffer commands, std::uint32_t count,
    const VkAccelerationStructureBuildGeometryInfoKHR* infos,
    const VkAccelerationStructureBuildRangeInfoKHR* const* ranges) {
  Device& device = device_of(commands);
  device.table().CmdBuildAccelerationStructuresKHR(commands, count, infos, ranges);
  if (!device.watches_builds()) {
    return;
  }
  auto builds = std::make_shared<std::vector<StructureBuild>>();
  for (std::uint32_t i = 0; i < count; ++i) {
    builds->push_back(copy_build(infos[i], ranges[i]));
  }
  device.add_callback(commands, [&device, builds] {
    for (const StructureBuild& build : *builds) {
      device.structure_writer().built(build);
    }
  });
}

void CmdBuildAccelerationStructuresIndirectKHR(
    VkCommandBuffer commands, std::uint32_t count,
    const VkAccelerationStructureBuildGeometryInfoKHR* infos, const VkDeviceAddress* addresses,
    const std::uint32_t* strides, const std::uint32_t* const* most_primitives) {
  Device& device = device_of(commands);
  device.refuse_once(
      "indirect builds of acceleration structures (lavapipe does not support them) are not "
      "captured");
  device.table().CmdBuildAccelerationStructuresIndirectKHR(commands, count, infos, addresses,
                                                           strides, most_primitives);
}

VkResult BuildAccelerationStructuresKHR(
    VkDevice handle, VkDeferredOperationKHR operation, std::uint32_t count,
    const VkAccelerationStructureBuildGeometryInfoKHR* infos,
    const VkAccelerationStructureBuildRangeInfoKHR* const* ranges) {
  Device& device = device_of(handle);
  device.refuse_once(
      "builds of acceleration structures on the host (lavapipe does not support them) are not "
      "captured");
  return device.table().BuildAccelerationStructuresKHR(handle, operation, count, infos, ranges);
}

void CmdCopyAccelerationStructureKHR(VkCommandBuffer commands,
                                     const VkCopyAccelerationStructureInfoKHR* info) {
  Device& device = device_of(commands);
  device.table().CmdCopyAccelerationStructureKHR(commands, info);
  if (device.watches_builds()) {
    device.add_callback(commands, [&device, source = info->src, destination = info->dst] {
      device.structure_writer().copied(source, destination);
    });
  }
}

void CmdCopyMemoryToAccelerationStructureKHR(
    VkCommandBuffer commands, const VkCopyMemoryToAccelerationStructureInfoKHR* info) {
  Device& device = device_of(commands);
  device.refuse_once("acceleration structures that come from serialized memory are not captured");
  device.table().CmdCopyMemoryToAccelerationStructureKHR(commands, info);
}

}  // namespace a2rt::layer::entry
