// Units and workloads for the tests of the rt room.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "a2rt/config/section.h"
#include "a2rt/rt/functional.h"
#include "a2rt/rt/unit.h"
#include "a2rt/workload/reference.h"
#include "a2rt/workload/synthetic.h"

namespace a2rt::rt {

inline std::unique_ptr<RtUnit> make_unit(const std::string& name, const std::string& toml = "") {
  const config::Section section = config::Section::from_text(toml, name + " (test)");
  std::unique_ptr<RtUnit> unit = unit_registry().create(name, section);
  section.reject_unknown_keys();
  return unit;
}

inline std::unique_ptr<RtUnit> built(const std::string& name, const Workload& workload,
                                     const std::string& toml = "") {
  std::unique_ptr<RtUnit> unit = make_unit(name, toml);
  unit->build(workload);
  return unit;
}

inline Workload scene(synthetic::Shape shape, std::uint32_t primitives = 400,
                      std::uint32_t instances = 1, double masked = 0) {
  synthetic::Config config;
  config.shape = shape;
  config.primitives = primitives;
  config.instances = instances;
  config.masked_share = masked;
  config.width = config.height = 20;
  return synthetic::make(config);
}

// Rays on which the answer differs from brute force. For rays that may return any hit, only whether
// there is one counts. (Brute force marks hits without a shader as inferred; a unit need not know.)
inline std::uint64_t differences(const Workload& workload, const std::vector<Hit>& hits) {
  std::uint64_t wrong = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    Hit truth = reference_hit(workload, workload.rays[i], candidates_of(workload, i));
    if (truth.state == HitState::kHitInferred) {
      truth.state = HitState::kHit;
    }
    const bool any = (workload.rays[i].flags & kRayTerminateOnFirstHit) != 0;
    const bool same = any ? hits[i].state == truth.state : hits[i] == truth;
    wrong += same ? 0U : 1U;
  }
  return wrong;
}

inline std::vector<Hit> hits_of(const RtUnit& unit, const Workload& workload) {
  FunctionalOptions options;
  options.events = false;
  return run_functional(unit, workload, options).hits;
}

}  // namespace a2rt::rt
