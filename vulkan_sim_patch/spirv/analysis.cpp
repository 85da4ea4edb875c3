#include "spirv/analysis.h"

#include <algorithm>

#include "spirv/function_pass.h"
#include "spirv/opcodes.h"
#include "spirv/values.h"

namespace a2rt::spirv {
namespace {

using spv::Op;

bool traces_unseen(Op op) {
  return op == Op::OpTraceRayMotionNV || op == Op::OpTraceMotionNV ||
         op == Op::OpHitObjectTraceRayNV || op == Op::OpHitObjectTraceRayMotionNV;
}

std::vector<std::string> module_warnings(const Module& module) {
  std::vector<std::string> warnings;
  for (const std::uint32_t opcode : module.unknown_opcodes()) {
    warnings.push_back(opcode_name(opcode) +
                       " is not in the SPIR-V grammar of this build: passed through, not counted");
  }
  for (const Function& function : module.functions()) {
    const auto unseen = std::ranges::find_if(
        function.code, [](const Instruction& i) { return traces_unseen(i.op()); });
    if (unseen != function.code.end()) {
      warnings.push_back(opcode_name(static_cast<std::uint32_t>(unseen->op())) + " at word " +
                         std::to_string(unseen->offset()) + ": its rays are not recorded");
      break;
    }
  }
  return warnings;
}

EntryPoint describe(const EntryDeclaration& declaration, const RayFeatures& features) {
  EntryPoint entry;
  entry.name = declaration.name;
  entry.execution_model = declaration.model;
  entry.stage = stage_of(declaration.model);
  entry.uses_ray_query = features.query_uses;
  entry.executes_callable = features.executes_callable;
  entry.reports_intersection = features.reports_intersection;
  entry.ignores_intersection = features.ignores_intersection;
  entry.terminates_ray = features.terminates_ray;
  entry.writes_state = features.writes_state;
  return entry;
}

std::array<std::uint32_t, 3> local_size(const Module& module, const ValueTracer& values,
                                        Id function) {
  std::array<std::uint32_t, 3> size{};
  for (const Instruction& i : module.globals()) {
    const bool is_mode = i.op() == Op::OpExecutionMode || i.op() == Op::OpExecutionModeId;
    if (is_mode && i.operand_count() >= 5 && i.operand(0) == function) {
      const auto mode = static_cast<spv::ExecutionMode>(i.operand(1));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (mode == spv::ExecutionMode::LocalSize) {
          size[axis] = i.operand(2 + axis);
        } else if (mode == spv::ExecutionMode::LocalSizeId) {
          size[axis] = values.constant(i.operand(2 + axis)).value_or(0);
        }
      }
    }
  }
  // The decorated constant wins over the modes.
  for (const Instruction& i : module.globals()) {
    const bool is_decoration =
        i.op() == Op::OpDecorate && i.operand_count() >= 3 &&
        i.operand(1) == static_cast<std::uint32_t>(spv::Decoration::BuiltIn) &&
        i.operand(2) == static_cast<std::uint32_t>(spv::BuiltIn::WorkgroupSize);
    const Instruction* const constant = is_decoration ? module.definition(i.operand(0)) : nullptr;
    if (constant == nullptr) {
      continue;
    }
    const bool is_list = (constant->op() == Op::OpConstantComposite ||
                          constant->op() == Op::OpSpecConstantComposite) &&
                         constant->operand_count() == 3;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      size[axis] = is_list ? values.constant(constant->operand(axis)).value_or(0) : 0;
    }
  }
  return size;
}

TraceSite describe_site(const Instruction& trace, const ValueTracer& values, std::uint32_t number) {
  TraceSite site;
  site.site = number;
  site.is_query = trace.op() == Op::OpRayQueryInitializeKHR;
  const std::size_t structure = site.is_query ? 1 : 0;
  site.structure = values.structure(trace.operand(structure));
  site.ray_flags = values.constant(trace.operand(structure + 1));
  site.cull_mask = values.constant(trace.operand(structure + 2));
  if (site.cull_mask) {
    *site.cull_mask &= 0xffu;
  }
  return site;
}

}  // namespace

bool Analysis::has_rays() const {
  return std::ranges::any_of(entry_points, [](const EntryPoint& e) {
    return e.uses_ray_query || is_ray_tracing_stage(e.execution_model);
  });
}

bool can_record(const EntryPoint& entry, const RayFeatures& features) {
  const bool may_query =
      entry.stage == capture::Stage::kCompute || entry.stage == capture::Stage::kFragment;
  return is_ray_tracing_stage(entry.execution_model) || (may_query && features.query_initializes);
}

std::string reason_to_pass_through(const Module& module) {
  for (const Instruction& instruction : module.globals()) {
    if (instruction.op() == Op::OpMemoryModel) {
      const auto model = static_cast<spv::AddressingModel>(instruction.operand(0));
      if (model == spv::AddressingModel::Physical32 || model == spv::AddressingModel::Physical64) {
        return "its addressing model is that of OpenCL";
      }
    }
  }
  if (module.has_capability(spv::Capability::RayTracingNV)) {
    return "it uses SPV_NV_ray_tracing, which lavapipe does not run; compile it for "
           "SPV_KHR_ray_tracing";
  }
  return {};
}

Analysis analyse_module(const Module& module, const CallGraph& calls,
                        std::optional<std::span<const Specialization>> specializations) {
  Analysis analysis;
  analysis.version = module.version();
  analysis.warnings = module_warnings(module);
  const ValueTracer values(module, calls, specializations);
  std::vector<std::vector<std::uint32_t>> sites_of(module.functions().size());
  for (std::size_t f = 0; f < module.functions().size(); ++f) {
    for (const Instruction& instruction : module.functions()[f].code) {
      if (is_trace_site(instruction)) {
        const auto number = static_cast<std::uint32_t>(analysis.sites.size());
        sites_of[f].push_back(number);
        analysis.sites.push_back(describe_site(instruction, values, number));
      }
    }
  }
  for (const EntryDeclaration& declaration : entry_declarations(module)) {
    const auto reached = calls.reached(declaration.function);
    EntryPoint entry = describe(declaration, calls.features(reached));
    for (const std::size_t f : reached) {
      entry.sites.insert(entry.sites.end(), sites_of[f].begin(), sites_of[f].end());
    }
    if (entry.stage == capture::Stage::kCompute) {
      entry.local_size = local_size(module, values, declaration.function);
    }
    analysis.entry_points.push_back(std::move(entry));
  }
  return analysis;
}

Analysis analyse(std::span<const std::uint32_t> words,
                 std::span<const Specialization> specializations) {
  const Module module = Module::parse(words);
  return analyse_module(module, CallGraph(module), specializations);
}

}  // namespace a2rt::spirv
