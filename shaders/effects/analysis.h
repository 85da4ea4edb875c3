// Which effects a scene calls for under a workload, and which of them are built.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "effects/effect.h"
#include "scene/scene.h"
#include "workloads/workload_config.h"

namespace a2rt::effects {

struct Call {
  Effect effect;
  bool supported = false;                  // by the workload's shaders
  std::vector<std::string> called_for_by;  // materials, lights, nodes; empty: by nothing
  bool needed() const { return supported && !called_for_by.empty(); }
};

// Decided from the scene and the workload alone; one entry per effect, in the order of all().
std::vector<Call> analyse(const scene::Scene& scene, const workloads::WorkloadConfig& workload);

// True if some of its triangles' coverage is below what the alpha mode lets through.
bool has_holes(const scene::Scene& scene, const scene::Material& material);

// True if rays pass the backs of its triangles: single-sided, and not the wall of a body of glass.
bool culls(const scene::Material& material);

// True if shadow rays go to points on emitting triangles. LumiBench's shadow workload aims at a sun
// instead, so its scenes do not.
bool samples_emitters(const scene::Scene& scene, const workloads::WorkloadConfig& workload);

// What is compiled and traced.
struct Choice {
  std::uint32_t built = 0;           // effect bits
  std::uint32_t called_for = 0;      // by the scene, whatever is built
  std::vector<std::string> lacking;  // seen in the picture but left out by the user's list
  bool has(std::uint32_t bit) const { return (built & bit) != 0; }
  // Built and called for: what may change geometry, flags or rays.
  bool uses(std::uint32_t bit) const { return (built & called_for & bit) != 0; }
};

// `selection` is "auto" (what is needed), "all" (everything), or a comma-separated list that
// restricts auto. Throws UserError for unknown names.
Choice choose(const std::vector<Call>& calls, const std::string& selection);

}  // namespace a2rt::effects
