// The settings of a render and the uniform block made from them.
#pragma once

#include <cstdint>

#include "glsl/shared.h"
#include "scene/scene.h"
#include "workloads/workload_config.h"

namespace a2rt::render {

struct Settings {
  std::uint32_t width = 128, height = 128;
  std::uint32_t samples = 2;
  std::uint32_t frames = 1;
  std::uint32_t seed = 1;
  float exposure = 1;
  float ao_distance = 0;  // world units; 0: as the workload says
  bool lumibench_shadow = false;
  bool count_rays = false;
};

// Camera, sky, ray interval and counts; first_sample and samples are set per dispatch.
// Throws UserError if the camera sees nothing.
gpu::Frame make_frame(const scene::Scene& scene, const scene::Camera& camera,
                      const workloads::WorkloadConfig& workload, const Settings& settings);

}  // namespace a2rt::render
