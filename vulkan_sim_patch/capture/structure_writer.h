// What happens to an acceleration structure right after the driver has built it: check it against
// the program's inputs, rebuild its box nodes, write it to the manifest.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <vector>

#include "capture/manifest_writer.h"
#include "state/structures.h"

namespace a2rt::layer {

// A deep copy of one element of a build command.
struct StructureBuild {
  VkAccelerationStructureKHR target = VK_NULL_HANDLE;
  VkAccelerationStructureTypeKHR type = VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR;
  VkBuildAccelerationStructureFlagsKHR flags = 0;
  bool is_update = false;
  std::vector<VkAccelerationStructureGeometryKHR> geometries;
  std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges;

  std::uint64_t primitives() const;
};

struct StructureOptions {
  bool rebuild = true;
  unsigned threads = 2;
};

// Levels of box nodes that a BLAS may have; lavapipe's stack of 48 entries serves a TLAS as well.
inline constexpr std::uint32_t kBlasDepthLimit = 30;
inline constexpr std::uint32_t kStackEntries = 47;  // one is in use for the current node

class StructureWriter {
 public:
  // `manifest` may be null: then structures are rebuilt but not written.
  StructureWriter(Structures& structures, ManifestWriter* manifest, StructureOptions options)
      : structures_(structures), manifest_(manifest), options_(options) {}

  // Both are called between the driver's build or copy and the first use of its result.
  void built(const StructureBuild& build);
  void copied(VkAccelerationStructureKHR source, VkAccelerationStructureKHR destination);

 private:
  void bottom_level(const StructureBuild& build, VkDeviceAddress address);
  void top_level(const StructureBuild& build, VkDeviceAddress address);
  void refuse(const std::string& what);

  Structures& structures_;
  ManifestWriter* manifest_;
  StructureOptions options_;
};

}  // namespace a2rt::layer
