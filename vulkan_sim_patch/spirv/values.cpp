#include "spirv/values.h"

#include <algorithm>

namespace a2rt::spirv {
namespace {

using spv::Op;

std::optional<std::uint32_t> compute(Op op, std::uint32_t a, std::uint32_t b) {
  switch (op) {
    case Op::OpBitwiseOr:
      return a | b;
    case Op::OpBitwiseAnd:
      return a & b;
    case Op::OpBitwiseXor:
      return a ^ b;
    case Op::OpIAdd:
      return a + b;
    case Op::OpISub:
      return a - b;
    case Op::OpShiftLeftLogical:
      return b < 32 ? std::optional(a << b) : std::nullopt;
    case Op::OpShiftRightLogical:
      return b < 32 ? std::optional(a >> b) : std::nullopt;
    default:
      return std::nullopt;
  }
}

}  // namespace

ValueTracer::ValueTracer(const Module& module, const CallGraph& calls,
                         std::optional<std::span<const Specialization>> specializations)
    : module_(module), calls_(calls), specialize_(specializations.has_value()) {
  if (specializations) {
    for (const Specialization& s : *specializations) {
      specializations_[s.constant_id] = s.value;
    }
  }
  for (const Instruction& instruction : module.globals()) {
    if (instruction.op() != Op::OpDecorate || instruction.operand_count() < 3) {
      continue;
    }
    switch (static_cast<spv::Decoration>(instruction.operand(1))) {
      case spv::Decoration::SpecId:
        spec_ids_[instruction.operand(0)] = instruction.operand(2);
        break;
      case spv::Decoration::DescriptorSet:
        sets_[instruction.operand(0)] = instruction.operand(2);
        break;
      case spv::Decoration::Binding:
        bindings_[instruction.operand(0)] = instruction.operand(2);
        break;
      default:
        break;
    }
  }
  for (const Function& function : module.functions()) {
    note_uses(function);
  }
}

void ValueTracer::note_uses(const Function& function) {
  std::size_t position = 0;
  for (const Instruction& instruction : function.code) {
    if (instruction.op() == Op::OpFunctionParameter) {
      parameters_[instruction.result()] = {function.id, position++};
    }
    if (instruction.op() == Op::OpVariable || instruction.op() == Op::OpFunctionParameter) {
      uses_.emplace(instruction.result(), Uses{});
    }
  }
  for (const Instruction& instruction : function.code) {
    const Op op = instruction.op();
    const auto operands = instruction.operands();
    if (op == Op::OpVariable && operands.size() > 1) {
      uses_[instruction.result()].stored.push_back(operands[1]);  // initializer
    }
    if (op == Op::OpVariable || op == Op::OpLoad || op == Op::OpFunctionCall) {
      continue;  // what a callee does with its parameter is looked up there
    }
    for (std::size_t i = 0; i < operands.size(); ++i) {
      // Without operand kinds a literal may look like an id; that only makes us less certain.
      const auto used = uses_.find(operands[i]);
      if (used == uses_.end()) {
        continue;
      }
      if (op == Op::OpStore && i == 0) {
        used->second.stored.push_back(instruction.operand(1));
      } else if (op != Op::OpExtInst) {
        used->second.other = true;
      }
    }
  }
  for (const Instruction& call : function.code) {
    for (std::size_t i = 1; call.op() == Op::OpFunctionCall && i < call.operand_count(); ++i) {
      const auto used = uses_.find(call.operand(i));
      const Function* const callee = module_.function(call.operand(0));
      if (used == uses_.end() || callee == nullptr) {
        continue;
      }
      // A pointer handed to a callee may be written there.
      std::size_t parameter = 0;
      for (const Instruction& inner : callee->code) {
        if (inner.op() == Op::OpFunctionParameter && ++parameter == i) {
          used->second.other |= std::ranges::any_of(callee->code, [&](const Instruction& user) {
            return user.op() != Op::OpLoad && user.op() != Op::OpFunctionParameter &&
                   user.op() != Op::OpExtInst &&
                   std::ranges::find(user.operands(), inner.result()) != user.operands().end();
          });
        }
      }
    }
  }
}

std::optional<std::uint32_t> ValueTracer::constant(Id value) const {
  int steps = kSteps;
  return evaluate(value, steps);
}

ValueTracer::Step ValueTracer::specialized(const Instruction& constant) const {
  if (!specialize_) {
    return std::nullopt;
  }
  const auto spec = spec_ids_.find(constant.result());
  const auto given =
      spec == spec_ids_.end() ? specializations_.end() : specializations_.find(spec->second);
  return given != specializations_.end() ? given->second : constant.operand(0);
}

ValueTracer::Step ValueTracer::evaluate_binary(const Instruction& instruction, Op op,
                                               std::size_t first, int& steps) const {
  if (instruction.operand_count() < first + 2) {
    return std::nullopt;
  }
  const Step a = evaluate(instruction.operand(first), steps);
  const Step b = a ? evaluate(instruction.operand(first + 1), steps) : std::nullopt;
  return b ? compute(op, *a, *b) : std::nullopt;
}

ValueTracer::Step ValueTracer::evaluate(Id value, int& steps) const {
  const Instruction* const defined = module_.definition(value);
  if (--steps < 0 || defined == nullptr) {
    return std::nullopt;
  }
  switch (defined->op()) {
    case Op::OpConstant:
      return defined->operand(0);
    case Op::OpConstantNull:
      return 0u;
    case Op::OpSpecConstant:
      return specialized(*defined);
    case Op::OpSpecConstantOp:
      return specialize_ ? evaluate_binary(*defined, static_cast<Op>(defined->operand(0)), 1, steps)
                         : std::nullopt;
    case Op::OpCopyObject:
    case Op::OpBitcast:
      return evaluate(defined->operand(0), steps);
    case Op::OpFunctionParameter:
      return agreed(arguments(value), [&](Id a) { return evaluate(a, steps); });
    case Op::OpLoad:
      return evaluate_load(defined->operand(0), steps);
    default:
      return evaluate_binary(*defined, defined->op(), 0, steps);
  }
}

template <class List, class Evaluate>
ValueTracer::Step ValueTracer::agreed(const List& list, Evaluate evaluate_one) const {
  Step common;
  for (const Id member : list) {
    const Step value = evaluate_one(member);
    if (!value || (common && *common != *value)) {
      return std::nullopt;
    }
    common = value;
  }
  return common;
}

ValueTracer::Step ValueTracer::evaluate_load(Id pointer, int& steps) const {
  if (--steps < 0) {
    return std::nullopt;
  }
  if (!is_parameter(pointer)) {
    return evaluate(only_stored(pointer), steps);
  }
  const auto used = uses_.find(pointer);
  if (used == uses_.end() || used->second.other || !used->second.stored.empty()) {
    return std::nullopt;
  }
  return agreed(arguments(pointer), [&](Id a) { return evaluate_load(a, steps); });
}

Id ValueTracer::only_stored(Id variable) const {
  const auto used = uses_.find(variable);
  const bool single = used != uses_.end() && !used->second.other && used->second.stored.size() == 1;
  return single ? used->second.stored[0] : 0;
}

std::vector<Id> ValueTracer::arguments(Id parameter) const {
  std::vector<Id> passed;
  const auto place = parameters_.find(parameter);
  if (place != parameters_.end()) {
    for (const Instruction* const call : calls_.calls_of(place->second.first)) {
      const std::size_t operand = place->second.second + 1;
      passed.push_back(operand < call->operand_count() ? call->operand(operand) : 0);
    }
  }
  return passed;
}

StructureSource ValueTracer::structure(Id value) const {
  StructureSource found;
  int steps = kSteps;
  source(value, found, steps);
  return found;
}

void ValueTracer::source_of_parameter(Id parameter, StructureSource& found, int& steps) const {
  std::optional<StructureSource> common;
  for (const Id argument : arguments(parameter)) {
    StructureSource one;
    source(argument, one, steps);
    if (common && *common != one) {
      return;
    }
    common = one;
  }
  found = common.value_or(StructureSource{});
}

void ValueTracer::source(Id value, StructureSource& found, int& steps) const {
  const Instruction* const defined = module_.definition(value);
  if (--steps < 0 || defined == nullptr) {
    return;
  }
  switch (defined->op()) {
    case Op::OpConvertUToAccelerationStructureKHR:
      found.kind = StructureSource::Kind::kAddress;
      return;
    case Op::OpLoad: {
      const Id only = only_stored(defined->operand(0));
      source(only != 0 ? only : defined->operand(0), found, steps);
      return;
    }
    case Op::OpCopyObject:
      source(defined->operand(0), found, steps);
      return;
    case Op::OpFunctionParameter:
      source_of_parameter(value, found, steps);
      return;
    case Op::OpAccessChain:
    case Op::OpInBoundsAccessChain:
      found.is_array = true;
      found.element = defined->operand_count() == 2 ? constant(defined->operand(1)) : std::nullopt;
      source(defined->operand(0), found, steps);
      return;
    case Op::OpVariable: {
      const auto set = sets_.find(value);
      const auto binding = bindings_.find(value);
      if (set != sets_.end() && binding != bindings_.end()) {
        found.kind = StructureSource::Kind::kDescriptor;
        found.set = set->second;
        found.binding = binding->second;
      }
      return;
    }
    default:
      return;
  }
}

}  // namespace a2rt::spirv
