// The command line of a2rt-render.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "render/frame.h"

namespace a2rt::render {

struct Options {
  std::string scene;  // file or embedded name
  std::string workload = "auto";
  std::string effects = "auto";
  std::string camera;  // name, number, or eye/centre/fov; empty: the scene's first, else automatic
  std::string sky = "auto";
  std::optional<double> clamp_indirect;
  std::optional<std::uint32_t> width, height, samples, max_bounces, shadow_rays, ao_rays;
  std::uint32_t frames = 1, seed = 1, timing = 0, samples_per_dispatch = 0;
  float exposure = 1;
  std::string ao_distance;  // world units, or "relative:SHARE"
  bool lumibench_shadow = false, count_rays = false, strict_textures = false;
  bool list_effects = false, list_scenes = false, list_workloads = false, quiet = false;
  std::filesystem::path png, hdr, json, export_gltf;
};

// Parses; nullopt with `status` set means: nothing to do (help, or an error already printed).
std::optional<Options> parse_options(int argc, char** argv, int& status);

}  // namespace a2rt::render
