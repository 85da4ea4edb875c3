#include "render/frame.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "a2rt/base/error.h"
#include "effects/analysis.h"

namespace a2rt::render {
namespace {

void set_camera(gpu::Frame& frame, const scene::Camera& camera, const Settings& settings) {
  const glm::vec3 forward = glm::normalize(camera.forward);
  const glm::vec3 right = glm::normalize(glm::cross(forward, camera.up));
  const glm::vec3 up = glm::cross(right, forward);
  const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
  const bool orthographic = camera.orthographic_height > 0;
  const float half_height = orthographic
                                ? 0.5F * camera.orthographic_height
                                : std::tan(0.5F * camera.vertical_fov) * camera.focus_distance;
  frame.eye = camera.eye;
  frame.aperture_radius = orthographic ? 0 : 0.5F * camera.aperture;
  frame.forward = forward * camera.focus_distance;
  frame.right = right * (half_height * aspect);
  frame.up = up * half_height;
  frame.orthographic = orthographic ? 1 : 0;
  for (const glm::vec3& v : {frame.forward, frame.right, frame.up}) {
    const float length = glm::length(v);
    if (!(length > 0) || !std::isfinite(length)) {
      throw UserError("camera '" + camera.name +
                      "' sees no area at this picture size; choose another field of view");
    }
  }
}

// LumiBench's constants for LumiBench's scenes; elsewhere the interval follows the scene's size.
void set_interval(gpu::Frame& frame, const scene::Scene& scene,
                  const workloads::WorkloadConfig& workload, const Settings& settings) {
  const float diagonal = scene::world_bounds(scene).diagonal();
  frame.use_offset = scene.lumibench ? 0 : 1;
  frame.t_min = scene.lumibench ? 1e-3F : std::max(1e-6F * diagonal, 1e-30F);
  frame.t_max = scene.lumibench ? 1e4F : 1e30F;
  frame.ao_distance = settings.ao_distance > 0 ? settings.ao_distance
                      : scene.lumibench        ? static_cast<float>(workload.ao_lumibench)
                                        : static_cast<float>(workload.ao_distance) * diagonal;
}

// A directional light with an extent is a sun: cameras and mirrors see its disc.
void set_sun(gpu::Frame& frame, const scene::Scene& scene) {
  frame.sun_direction = scene.sun_direction;
  frame.sun_cos = 2;
  if (scene.lights.empty()) {
    return;
  }
  const scene::Light& first = scene.lights.front();
  if (first.kind == scene::LightKind::kDirectional && first.radius > 0) {
    const float cosine = 1 / std::sqrt(1 + first.radius * first.radius);
    frame.sun_cos = cosine;
    frame.sun_radiance = first.color / (6.2831853F * (1 - cosine));
  }
}

}  // namespace

gpu::Frame make_frame(const scene::Scene& scene, const scene::Camera& camera,
                      const workloads::WorkloadConfig& workload, const Settings& settings) {
  gpu::Frame frame{};
  set_camera(frame, camera, settings);
  set_interval(frame, scene, workload, settings);
  set_sun(frame, scene);
  if (scene.sky.present) {
    frame.sky_bottom = scene.sky.bottom;
    frame.sky_top = scene.sky.top;
  }
  frame.shadow_factor = static_cast<float>(workload.shadow_factor);
  frame.ao_factor = static_cast<float>(workload.ao_factor);
  frame.seed = settings.seed;
  frame.max_bounces = workload.max_bounces;
  frame.shadow_rays = workload.shadow_rays;
  frame.ao_rays = workload.ao_rays;
  frame.light_sampling = effects::samples_emitters(scene, workload) ? 1 : 0;
  frame.clamp_indirect = static_cast<float>(workload.clamp_indirect);
  frame.exposure = settings.exposure;
  const std::uint64_t samples = std::uint64_t{settings.samples} * settings.frames;
  frame.sample_bits = std::min(31U, static_cast<unsigned>(std::bit_width(samples - 1)));
  return frame;
}

}  // namespace a2rt::render
