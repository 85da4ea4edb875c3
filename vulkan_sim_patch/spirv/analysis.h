// The analysis behind analyse() and instrument(): entry points, trace sites, warnings.
#pragma once

#include <optional>

#include "spirv/call_graph.h"
#include "spirv/instrument.h"

namespace a2rt::spirv {

Analysis analyse_module(const Module& module, const CallGraph& calls,
                        std::optional<std::span<const Specialization>> specializations);

// True if records can be written for this entry point: a ray-tracing stage, or a compute or
// fragment shader that starts ray queries.
bool can_record(const EntryPoint& entry, const RayFeatures& features);

// Why a module has to be left alone; empty if it need not be.
std::string reason_to_pass_through(const Module& module);

}  // namespace a2rt::spirv
