#include "spirv/call_graph.h"

#include <algorithm>
#include <optional>

#include "spirv/opcodes.h"

namespace a2rt::spirv {
namespace {

std::optional<spv::StorageClass> storage_of(const Module& module, Id pointer) {
  const Instruction* const type = module.definition(module.type_of(pointer));
  if (type == nullptr || type->op() != spv::Op::OpTypePointer) {
    return std::nullopt;
  }
  return static_cast<spv::StorageClass>(type->operand(0));
}

// Storage that nothing but the invocation itself, or the hit it reports, can see.
bool is_own(const Module& module, Id pointer) {
  const auto storage = storage_of(module, pointer);
  return storage == spv::StorageClass::Function || storage == spv::StorageClass::Private ||
         storage == spv::StorageClass::HitAttributeKHR;
}

bool writes_beyond_itself(const Module& module, const Instruction& instruction) {
  const spv::Op op = instruction.op();
  switch (op) {
    case spv::Op::OpStore:
    case spv::Op::OpCopyMemory:
    case spv::Op::OpCopyMemorySized:
      return !is_own(module, instruction.operand(0));
    case spv::Op::OpImageWrite:
    case spv::Op::OpExecuteCallableKHR:
    case spv::Op::OpAtomicFAddEXT:
    case spv::Op::OpAtomicFMinEXT:
    case spv::Op::OpAtomicFMaxEXT:
      return true;
    default:
      return op >= spv::Op::OpAtomicStore && op <= spv::Op::OpAtomicXor;
  }
}

bool writes_output(const Module& module, const Instruction& instruction) {
  const spv::Op op = instruction.op();
  const bool copies =
      op == spv::Op::OpStore || op == spv::Op::OpCopyMemory || op == spv::Op::OpCopyMemorySized;
  return copies && storage_of(module, instruction.operand(0)) == spv::StorageClass::Output;
}

}  // namespace

void RayFeatures::include(const RayFeatures& other) {
  traces |= other.traces;
  query_initializes |= other.query_initializes;
  query_uses |= other.query_uses;
  executes_callable |= other.executes_callable;
  reports_intersection |= other.reports_intersection;
  ignores_intersection |= other.ignores_intersection;
  terminates_ray |= other.terminates_ray;
  writes_state |= other.writes_state;
  writes_memory |= other.writes_memory;
  discards |= other.discards;
  is_ordered |= other.is_ordered;
}

std::vector<EntryDeclaration> entry_declarations(const Module& module) {
  std::vector<EntryDeclaration> entries;
  for (const Instruction& instruction : module.globals()) {
    if (instruction.op() != spv::Op::OpEntryPoint) {
      continue;
    }
    EntryDeclaration entry;
    entry.instruction = &instruction;
    entry.model = instruction.operand(0);
    entry.function = instruction.operand(1);
    std::size_t next = 0;
    entry.name = instruction.string_operand(2, &next);
    for (std::size_t i = next; i < instruction.operand_count(); ++i) {
      entry.interface.push_back(instruction.operand(i));
    }
    if (module.function(entry.function) == nullptr) {
      instruction.fail("names %" + std::to_string(entry.function) + ", which is not a function");
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

capture::Stage stage_of(std::uint32_t execution_model) {
  using spv::ExecutionModel;
  switch (static_cast<ExecutionModel>(execution_model)) {
    case ExecutionModel::RayGenerationKHR:
      return capture::Stage::kRayGeneration;
    case ExecutionModel::IntersectionKHR:
      return capture::Stage::kIntersection;
    case ExecutionModel::AnyHitKHR:
      return capture::Stage::kAnyHit;
    case ExecutionModel::ClosestHitKHR:
      return capture::Stage::kClosestHit;
    case ExecutionModel::MissKHR:
      return capture::Stage::kMiss;
    case ExecutionModel::CallableKHR:
      return capture::Stage::kCallable;
    case ExecutionModel::GLCompute:
      return capture::Stage::kCompute;
    case ExecutionModel::Fragment:
      return capture::Stage::kFragment;
    default:
      return capture::Stage::kOther;
  }
}

bool is_ray_tracing_stage(std::uint32_t execution_model) {
  return stage_of(execution_model) <= capture::Stage::kCallable;
}

CallGraph::CallGraph(const Module& module) {
  const auto& functions = module.functions();
  for (std::size_t i = 0; i < functions.size(); ++i) {
    index_.emplace(functions[i].id, i);
  }
  nodes_.resize(functions.size());
  for (std::size_t i = 0; i < functions.size(); ++i) {
    scan(module, functions[i], nodes_[i]);
  }
  spread_flushes();
}

void CallGraph::scan(const Module& module, const Function& function, Node& node) {
  using spv::Op;
  RayFeatures& f = node.features;
  for (const Instruction& instruction : function.code) {
    const bool writes = writes_beyond_itself(module, instruction);
    f.writes_state = f.writes_state || writes;
    f.writes_memory = f.writes_memory || (writes && !writes_output(module, instruction));
    f.is_ordered =
        f.is_ordered || opcode_info(static_cast<std::uint32_t>(instruction.op())) == nullptr;
    switch (instruction.op()) {
      case Op::OpFunctionCall: {
        const auto callee = index_.find(instruction.operand(0));
        if (callee == index_.end()) {
          instruction.fail("calls %" + std::to_string(instruction.operand(0)) +
                           ", which is not a function");
        }
        node.callees.push_back(callee->second);
        calls_[callee->first].push_back(&instruction);
        break;
      }
      case Op::OpKill:
      case Op::OpTerminateInvocation:
      case Op::OpDemoteToHelperInvocation:
        f.discards = true;
        break;
      case Op::OpBeginInvocationInterlockEXT:
        f.is_ordered = true;
        break;
      case Op::OpTraceRayKHR:
        f.traces = true;
        break;
      case Op::OpExecuteCallableKHR:
        f.executes_callable = true;
        break;
      case Op::OpReportIntersectionKHR:
        f.reports_intersection = true;
        break;
      case Op::OpIgnoreIntersectionKHR:
        f.ignores_intersection = true;
        break;
      case Op::OpTerminateRayKHR:
        f.terminates_ray = true;
        break;
      case Op::OpRayQueryInitializeKHR:
        f.query_initializes = true;
        [[fallthrough]];
      case Op::OpRayQueryProceedKHR:
      case Op::OpRayQueryTerminateKHR:
      case Op::OpRayQueryConfirmIntersectionKHR:
      case Op::OpRayQueryGenerateIntersectionKHR:
        f.query_uses = true;
        break;
      default:
        break;
    }
  }
  node.may_flush = f.traces || f.query_initializes || f.executes_callable || f.reports_intersection;
}

void CallGraph::spread_flushes() {
  for (bool changed = true; changed;) {
    changed = false;
    for (Node& node : nodes_) {
      if (!node.may_flush &&
          std::ranges::any_of(node.callees, [&](std::size_t c) { return nodes_[c].may_flush; })) {
        node.may_flush = true;
        changed = true;
      }
    }
  }
}

std::set<std::size_t> CallGraph::reached(Id root) const {
  std::set<std::size_t> seen;
  std::vector<std::size_t> open{index_.at(root)};
  while (!open.empty()) {
    const std::size_t at = open.back();
    open.pop_back();
    if (seen.insert(at).second) {
      open.insert(open.end(), nodes_[at].callees.begin(), nodes_[at].callees.end());
    }
  }
  return seen;
}

RayFeatures CallGraph::features(const std::set<std::size_t>& functions) const {
  RayFeatures all;
  for (const std::size_t f : functions) {
    all.include(nodes_[f].features);
  }
  return all;
}

bool CallGraph::may_flush(Id function) const {
  const auto found = index_.find(function);
  return found != index_.end() && nodes_[found->second].may_flush;
}

const std::vector<const Instruction*>& CallGraph::calls_of(Id function) const {
  static const std::vector<const Instruction*> kNone;
  const auto found = calls_.find(function);
  return found == calls_.end() ? kNone : found->second;
}

}  // namespace a2rt::spirv
