// manifest.bin: what the layer's host code wrote.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "a2rt/capture/manifest.h"
#include "a2rt/workload/workload.h"

namespace a2rt::import {

using SiteKey = std::pair<std::uint32_t, std::uint32_t>;  // shader, site

struct RawDispatch {
  capture::DispatchBlock block{};
  std::map<SiteKey, std::uint32_t> tlas;  // index into Workload::tlas, or kNone
  std::uint32_t only_tlas = kNone;        // what a site without binding traces
};

struct Manifest {
  std::vector<RawDispatch> dispatches;  // by dispatch index
  std::set<SiteKey> query_sites;
  capture::EndBlock end{};
  std::vector<std::string> refused;
};

// Parses the manifest; geometry, shaders and provenance go to `workload`. Throws UserError naming
// the byte.
Manifest read_manifest(std::span<const std::byte> bytes, Workload& workload);

}  // namespace a2rt::import
