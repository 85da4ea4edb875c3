// The few Vulkan objects that every test program needs: a headless device with ray tracing,
// host-visible buffers, acceleration structures, pipelines, one queue. Programs are foreign to the
// project on purpose: they include nothing of it and know nothing of the layer.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace foreign {

inline constexpr std::uint32_t kWidth = 96;
inline constexpr std::uint32_t kHeight = 64;

inline void check(VkResult result, const char* what) {
  if (result < 0) {
    throw std::runtime_error(std::string(what) + ": VkResult " + std::to_string(result));
  }
}

// Extension functions, loaded once per device.
#define FOREIGN_FUNCTIONS(X)                       \
  X(vkCmdBuildAccelerationStructuresKHR)           \
  X(vkCmdCopyAccelerationStructureKHR)             \
  X(vkCmdTraceRaysIndirect2KHR)                    \
  X(vkCmdTraceRaysIndirectKHR)                     \
  X(vkCmdTraceRaysKHR)                             \
  X(vkCmdPushDescriptorSetKHR)                     \
  X(vkCmdWriteAccelerationStructuresPropertiesKHR) \
  X(vkCreateAccelerationStructureKHR)              \
  X(vkCreateDeferredOperationKHR)                  \
  X(vkCreateRayTracingPipelinesKHR)                \
  X(vkDestroyAccelerationStructureKHR)             \
  X(vkDestroyDeferredOperationKHR)                 \
  X(vkGetAccelerationStructureBuildSizesKHR)       \
  X(vkGetAccelerationStructureDeviceAddressKHR)    \
  X(vkGetRayTracingShaderGroupHandlesKHR)

struct Buffer {
  VkBuffer handle = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkDeviceSize size = 0;
  VkDeviceAddress address = 0;
  void* mapped = nullptr;

  template <class T>
  std::span<T> as() const {
    return {static_cast<T*>(mapped), static_cast<std::size_t>(size / sizeof(T))};
  }
};

struct Structure {
  VkAccelerationStructureKHR handle = VK_NULL_HANDLE;
  Buffer buffer;
  VkDeviceAddress address = 0;
};

// One geometry of a BLAS; the buffers stay with it.
struct Geometry {
  VkAccelerationStructureGeometryKHR description{};
  VkAccelerationStructureBuildRangeInfoKHR range{};
};

struct StructureInput {
  VkAccelerationStructureTypeKHR type = VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR;
  VkBuildAccelerationStructureFlagsKHR flags =
      VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
  std::vector<Geometry> geometries;
};

struct Mesh {
  std::vector<float> positions;  // xyz
  std::vector<std::uint32_t> indices;
};
// A wavy square in the xy plane, n x n quads; a unit cube; a sphere of 2 n^2 triangles.
Mesh wavy_grid(std::uint32_t n);
Mesh cube();
Mesh sphere(std::uint32_t n);

struct Group {
  VkRayTracingShaderGroupTypeKHR type = VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR;
  std::uint32_t general = VK_SHADER_UNUSED_KHR;
  std::uint32_t closest_hit = VK_SHADER_UNUSED_KHR;
  std::uint32_t any_hit = VK_SHADER_UNUSED_KHR;
  std::uint32_t intersection = VK_SHADER_UNUSED_KHR;
};
Group general(std::uint32_t stage);
Group hit(std::uint32_t closest_hit, std::uint32_t any_hit = VK_SHADER_UNUSED_KHR,
          std::uint32_t intersection = VK_SHADER_UNUSED_KHR);

struct Stage {
  VkShaderStageFlagBits stage;
  std::string shader;  // name of the GLSL file, e.g. "simple.rgen"
};

struct RayPipeline {
  VkPipeline handle = VK_NULL_HANDLE;
  Buffer table;
  VkStridedDeviceAddressRegionKHR raygen{}, miss{}, hit{}, callable{};
};
// How many groups of each kind, in the order of the pipeline's groups.
struct TableShape {
  std::uint32_t miss = 1, hit = 1, callable = 0;
};

class App {
 public:
  App();
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  VkPhysicalDevice physical() const { return physical_; }
  VkDevice device() const { return device_; }
  VkQueue queue() const { return queue_; }
  VkCommandPool pool() const { return pool_; }
  VkDescriptorSetLayout set_layout() const { return set_layout_; }
  VkPipelineLayout layout() const { return layout_; }
  const Buffer& picture() const { return picture_; }

#define FOREIGN_MEMBER(name) PFN_##name name = nullptr;
  FOREIGN_FUNCTIONS(FOREIGN_MEMBER)
#undef FOREIGN_MEMBER

  Buffer make_buffer(VkDeviceSize size, const void* data = nullptr);
  template <class T>
  Buffer make_buffer(const std::vector<T>& data) {
    return make_buffer(data.size() * sizeof(T), data.data());
  }

  Geometry triangles(const Mesh& mesh, VkGeometryFlagsKHR flags = VK_GEOMETRY_OPAQUE_BIT_KHR);
  Geometry boxes(const std::vector<VkAabbPositionsKHR>& boxes, VkGeometryFlagsKHR flags = 0);
  Geometry instances(const std::vector<VkAccelerationStructureInstanceKHR>& list);
  static VkAccelerationStructureInstanceKHR instance(const Structure& blas,
                                                     const VkTransformMatrixKHR& transform,
                                                     std::uint32_t custom = 0);

  Structure make_structure(const StructureInput& input);
  Structure make_structure(VkAccelerationStructureTypeKHR type, VkDeviceSize size);
  void build(
      VkCommandBuffer commands, const StructureInput& input, const Structure& target,
      VkBuildAccelerationStructureModeKHR mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR);
  // Builds now.
  Structure build_now(const StructureInput& input);
  Structure blas(std::vector<Geometry> geometries);
  Structure tlas(const std::vector<VkAccelerationStructureInstanceKHR>& list);

  VkShaderModule module(const std::string& shader);
  VkPipelineShaderStageCreateInfo stage_info(const Stage& stage);
  // `layout` null: layout().
  RayPipeline ray_pipeline(const std::vector<Stage>& stages, const std::vector<Group>& groups,
                           TableShape shape, std::uint32_t recursion = 1,
                           VkPipelineLayout layout = VK_NULL_HANDLE);
  void fill_table(RayPipeline& pipeline, std::uint32_t groups, TableShape shape);
  VkPipeline compute_pipeline(const std::string& shader);

  // A set of set_layout(): binding 0 the structure, 1 the picture, 2 more data, 3 a second
  // structure.
  VkDescriptorSet make_set(const Structure& tlas, const Buffer* more = nullptr,
                           const Structure* second = nullptr);
  VkCommandBuffer make_commands(VkCommandBufferLevel level = VK_COMMAND_BUFFER_LEVEL_PRIMARY);
  static void begin(VkCommandBuffer commands, VkCommandBufferUsageFlags flags = 0);
  void trace(VkCommandBuffer commands, const RayPipeline& pipeline, VkDescriptorSet set);
  void submit(VkCommandBuffer commands);
  void run(const std::function<void(VkCommandBuffer)>& record);
  static void barrier(VkCommandBuffer commands);

 private:
  void create_device();
  void create_layouts();
  std::uint32_t memory_type(std::uint32_t allowed, VkMemoryPropertyFlags flags) const;

  VkInstance instance_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkDescriptorPool sets_ = VK_NULL_HANDLE;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  Buffer picture_;
  std::vector<Buffer> buffers_;
  std::vector<Structure> structures_;
  std::map<std::string, VkShaderModule> modules_;
  std::vector<VkPipeline> pipelines_;
};

VkTransformMatrixKHR translation(float x, float y, float z);

// SPIR-V of a GLSL file, compiled into the program.
std::span<const std::uint32_t> shader_words(const std::string& name);

// Programs register themselves: const Program one("name", run);
using Run = void (*)(App&);
struct Program {
  Program(const char* name, Run run);
};
const std::map<std::string, Run>& programs();

}  // namespace foreign
