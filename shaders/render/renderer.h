// Draws a scene: tables, acceleration structures and the pipeline composed from the effects.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "effects/analysis.h"
#include "render/frame.h"
#include "render/packed_scene.h"
#include "vulkan/acceleration_structure.h"
#include "vulkan/image.h"
#include "vulkan/pipeline.h"

namespace a2rt::render {

// Row 0 is the top.
struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // gamma 2, as LumiBench
  std::vector<float> rgb;          // linear mean of the samples
};

// Seconds.
struct Timings {
  double build = 0;     // acceleration structures
  double pipeline = 0;  // shader compilation, as far as the driver does it then
  std::vector<double> frames;
  // The same in seconds of all processors, which other programs on the machine do not lengthen.
  double pipeline_cpu = 0;
  std::vector<double> frames_cpu;
  double median_frame() const;
};

// Called between dispatches with the samples done so far, of how many.
using Progress = std::function<void(std::uint64_t done, std::uint64_t all)>;

// Frees a descriptor pool.
struct PoolDeleter {
  VkDevice device = VK_NULL_HANDLE;
  void operator()(VkDescriptorPool pool) const { vkDestroyDescriptorPool(device, pool, nullptr); }
};

class Renderer {
 public:
  Renderer(const vulkan::Context& context, const scene::Scene& scene, const scene::Camera& camera,
           const workloads::WorkloadConfig& workload, const effects::Choice& choice,
           const Settings& settings);

  // One frame is one dispatch, unless it is so long that it is cut by samples for the progress
  // display; `samples_per_dispatch` > 0 fixes the cut. The picture does not depend on it.
  Picture render(std::uint32_t samples_per_dispatch, const Progress& progress);
  // Draws the first frame `repeats` more times; only these count for the median. The picture that
  // render returned has warmed the driver up.
  void measure(std::uint32_t repeats);

  const Timings& timings() const { return timings_; }
  std::array<std::uint64_t, gpu::kRayKinds> ray_counts() const;
  const std::vector<std::string>& stage_files() const { return stage_files_; }
  std::uint64_t structure_bytes() const;

 private:
  void upload(const scene::Scene& scene);
  void build_structures();
  void build_bottom_level();
  void build_pipeline(const workloads::WorkloadConfig& workload);
  void write_descriptors();
  void dispatch(std::uint32_t first_sample, std::uint32_t samples);
  Picture read_back();

  const vulkan::Context& context_;
  effects::Choice choice_;
  Settings settings_;
  PackedScene packed_;
  gpu::Frame frame_;

  vulkan::Buffer vertices_, indices_, geometries_, materials_, shapes_, lights_, emitters_, counts_,
      uniforms_;
  std::vector<vulkan::Image> textures_;
  std::vector<vulkan::Sampler> samplers_;
  vulkan::Image accumulation_, picture_;
  std::vector<vulkan::AccelerationStructure> bottom_;
  vulkan::AccelerationStructure top_;
  std::unique_ptr<vulkan::Pipeline> pipeline_;
  std::vector<std::string> stage_files_;
  std::unique_ptr<std::remove_pointer_t<VkDescriptorPool>, PoolDeleter> pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  Timings timings_;
  std::array<std::uint64_t, gpu::kRayKinds> total_rays_{};
};

}  // namespace a2rt::render
