// One run of the program: load, decide, draw, write.
#pragma once

#include "effects/analysis.h"
#include "render/options.h"
#include "scene/scene.h"
#include "workloads/workload_config.h"

namespace a2rt::render {

// Loads a file or makes an embedded scene, and applies the options that change it (sky).
scene::Scene load_scene(const Options& options);

// "auto" is path tracing that samples the scene's emitters and lights where it has some.
workloads::WorkloadConfig choose_workload(const scene::Scene& scene, const Options& options);

// The camera the options name; the scene's first; or one that frames the scene.
scene::Camera choose_camera(const scene::Scene& scene, const std::string& name);

Settings make_settings(const scene::Scene& scene, const workloads::WorkloadConfig& workload,
                       const Options& options);

// Does what the options ask. Throws UserError; writes all its results or none.
void run(const Options& options);

}  // namespace a2rt::render
