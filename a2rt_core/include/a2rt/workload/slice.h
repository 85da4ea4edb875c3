// A smaller workload with the same geometry: all rays and segments of some launch ids.
#pragma once

#include <cstdint>
#include <functional>

#include "a2rt/workload/workload.h"

namespace a2rt {

// Keeps the launch ids for which `keep(dispatch, launch)` holds. Rays keep their launch, ordinal
// and dispatch; parents and segments are renumbered. Geometry is copied whole.
Workload slice(const Workload& workload,
               const std::function<bool(std::uint32_t dispatch, std::uint32_t launch)>& keep);

}  // namespace a2rt
