// One workload: which shaders, how many samples and rays, which effects it can show.
// On disk: lumibench_configs/workloads/NAME.toml.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace a2rt::workloads {

struct WorkloadConfig {
  std::string name, title, lumibench;
  // Stages, by file name in glsl/ without extension.
  std::string ray_generation;
  std::string triangle_closest_hit, shape_closest_hit;
  std::vector<std::string> misses;
  std::uint32_t recursion = 1;
  // Key of [stages] -> "file:line:column", for whoever finds that there is no such shader.
  std::map<std::string, std::string> stage_places;

  std::uint32_t width = 128, height = 128;
  std::uint32_t samples = 2;
  std::uint32_t max_bounces = 16;
  std::uint32_t shadow_rays = 0;  // per hit, of the workloads that ask for light by name
  std::uint32_t ao_rays = 0;
  double ao_distance = 0;  // share of the scene's diagonal; LumiBench scenes use ao_lumibench
  double ao_lumibench = 10;
  double shadow_factor = 1, ao_factor = 1;
  double clamp_indirect = 0;         // most radiance of a sample after a diffuse hit; 0: no limit
  bool light_sampling = false;       // emitters are sampled by shadow rays
  bool sun = false;                  // scenes without a light get a sun from a fixed direction
  bool opaque_geometry = true;       // false: every triangle is offered to the any-hit shader
  std::vector<std::string> effects;  // that the shaders can show, by name
  std::vector<std::string> rays;     // what is traced, in words
};

// The folder of configurations: $A2RT_CONFIGS, or the one of the source tree.
std::filesystem::path config_folder();
// Names of the workloads there, sorted.
std::vector<std::string> names();
// Throws UserError naming file:line:column, or the known workloads if there is none of that name.
// Shaders are looked up later, by the renderer.
WorkloadConfig load(const std::string& name);

}  // namespace a2rt::workloads
