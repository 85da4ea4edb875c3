// A minimal ray-tracing program for lavapipe: one scene, pipelines from given SPIR-V, and the
// record buffer that instrumented shaders write.
//
// The scene, seen along +z from z = 0: an opaque triangle over x in 0..1, a triangle that is not
// opaque over 2..3, a box over 4..5 (instance 1), nothing elsewhere; all at z = 5 over y in -1..1.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "a2rt/capture/records.h"

namespace a2rt::spirv::testing {

using Words = std::vector<std::uint32_t>;

class Driver;

// Host-visible memory with a device address.
class Buffer {
 public:
  Buffer(Driver& driver, VkDeviceSize bytes);
  ~Buffer();
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  VkBuffer handle() const { return buffer_; }
  VkDeviceAddress address() const { return address_; }
  template <class T>
  T* data() const {
    return static_cast<T*>(mapped_);
  }

 private:
  VkDevice device_;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  VkDeviceAddress address_ = 0;
  void* mapped_ = nullptr;
};

struct HitGroup {
  VkRayTracingShaderGroupTypeKHR type;
  std::uint32_t closest_hit, any_hit, intersection;  // stage index or VK_SHADER_UNUSED_KHR
};

struct RayTracingShaders {
  struct Stage {
    VkShaderStageFlagBits stage;
    Words words;
  };
  std::vector<Stage> stages;  // 0 = ray generation, 1 = miss
  std::vector<HitGroup> hits;
};

class Driver {
 public:
  // Null if this machine has no lavapipe with ray tracing.
  static std::unique_ptr<Driver> open();
  ~Driver();

  // Both keep the pipelines they make: lavapipe takes seconds to compile one.
  void trace(const RayTracingShaders& shaders, std::uint32_t width, std::uint32_t height);
  void dispatch(const Words& compute, std::uint32_t groups_x, std::uint32_t groups_y);

  VkDevice device() const { return device_; }
  std::uint32_t memory_type() const;

 private:
  friend class Buffer;
  Driver() = default;
  bool create();
  void build_scene();
  struct Structure {
    std::unique_ptr<Buffer> storage;
    VkAccelerationStructureKHR handle = VK_NULL_HANDLE;
    VkDeviceAddress address = 0;
  };
  Structure build(VkAccelerationStructureTypeKHR type,
                  std::span<const VkAccelerationStructureGeometryKHR> geometries,
                  std::uint32_t primitives);
  void create_descriptors();
  template <class Record>
  void submit(Record record);
  VkShaderModule module(const Words& words);
  VkPipeline ray_tracing_pipeline(const RayTracingShaders& shaders);
  VkPipeline compute_pipeline(const Words& compute);
  template <class Function>
  Function load(const char* name) const {
    return reinterpret_cast<Function>(vkGetDeviceProcAddr(device_, name));
  }

  VkInstance instance_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkDescriptorPool descriptors_ = VK_NULL_HANDLE;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  VkPhysicalDeviceRayTracingPipelinePropertiesKHR limits_{};
  std::vector<std::unique_ptr<Buffer>> kept_;
  std::vector<Structure> structures_;
  std::map<std::vector<Words>, VkPipeline> pipelines_;
};

// The record buffer with its header, ordinals and verdicts, and a reader of what was written.
class Recording {
 public:
  static constexpr std::uint32_t kGuard = 0xabababab;  // beyond the spare units
  Recording(Driver& driver, std::uint32_t most_units, std::uint32_t launches);
  // Starts anew with room for `capacity` units; the address stays.
  void reset(std::uint32_t capacity);

  std::uint64_t address() const { return header_.address(); }
  capture::RecordHeader& header() { return *header_.data<capture::RecordHeader>(); }
  void set_verdict(std::uint32_t launch, capture::VerdictEntry entry);  // for its first ray
  bool guard_intact() const;

  struct Record {
    capture::RecordKind kind;
    capture::Stage stage;
    std::uint32_t shader, launch, dispatch, ordinal;
    const std::uint32_t* words;  // of the whole record
    float real(std::size_t word) const;
    std::uint32_t counter(capture::Counter c) const;  // of kRay, kEnd, kSegment
  };
  // Records of one launch id in program order.
  std::vector<Record> of(std::uint32_t launch) const;
  std::size_t count() const;

 private:
  std::vector<Record> all() const;

  std::uint32_t most_units_, capacity_ = 0, launches_;
  Buffer header_, records_, ordinals_, index_, verdicts_;
};

}  // namespace a2rt::spirv::testing
