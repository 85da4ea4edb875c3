// Statistics and effects as JSON.
#pragma once

#include <string>
#include <vector>

#include "effects/analysis.h"
#include "render/renderer.h"
#include "scene/scene.h"
#include "workloads/workload_config.h"

namespace a2rt::render {

// {effect: {needed, called_for_by, stages, rays, part, built, why_not}}
std::string effects_json(const std::vector<effects::Call>& calls, const effects::Choice& choice,
                         const workloads::WorkloadConfig& workload);

struct ReportInput {
  const scene::Scene& scene;
  const scene::Camera& camera;
  const workloads::WorkloadConfig& workload;
  const std::vector<effects::Call>& calls;
  const effects::Choice& choice;
  const Settings& settings;
  const Renderer& renderer;
  std::string device, driver;
};
std::string stats_json(const ReportInput& input);

// The effects as a table for people.
std::string effects_table(const std::vector<effects::Call>& calls, const effects::Choice& choice);

}  // namespace a2rt::render
