#include "spirv/values.h"

#include <algorithm>
#include <limits>

namespace a2rt::spirv {
namespace {

using spv::Op;

using Word = std::optional<std::uint32_t>;

std::int32_t as_signed(std::uint32_t word) { return static_cast<std::int32_t>(word); }

// Signed division overflows for one pair of operands, and then as for 0 nothing is defined.
bool divides(std::int32_t a, std::int32_t b) {
  return b != 0 && !(a == std::numeric_limits<std::int32_t>::min() && b == -1);
}

Word divide(Op op, std::uint32_t a, std::uint32_t b) {
  if (op == Op::OpUDiv || op == Op::OpUMod) {
    return b == 0 ? Word() : op == Op::OpUDiv ? a / b : a % b;
  }
  const std::int32_t x = as_signed(a);
  const std::int32_t y = as_signed(b);
  if (!divides(x, y)) {
    return std::nullopt;
  }
  const std::int32_t remainder = x % y;  // has the sign of x
  switch (op) {
    case Op::OpSDiv:
      return static_cast<std::uint32_t>(x / y);
    case Op::OpSRem:
      return static_cast<std::uint32_t>(remainder);
    default:  // OpSMod: the sign of y
      return static_cast<std::uint32_t>(remainder != 0 && (remainder < 0) != (y < 0) ? remainder + y
                                                                                     : remainder);
  }
}

Word compare(Op op, std::uint32_t a, std::uint32_t b) {
  switch (op) {
    case Op::OpIEqual:
    case Op::OpLogicalEqual:
      return a == b;
    case Op::OpINotEqual:
    case Op::OpLogicalNotEqual:
      return a != b;
    case Op::OpULessThan:
      return a < b;
    case Op::OpULessThanEqual:
      return a <= b;
    case Op::OpUGreaterThan:
      return a > b;
    case Op::OpUGreaterThanEqual:
      return a >= b;
    case Op::OpSLessThan:
      return as_signed(a) < as_signed(b);
    case Op::OpSLessThanEqual:
      return as_signed(a) <= as_signed(b);
    case Op::OpSGreaterThan:
      return as_signed(a) > as_signed(b);
    case Op::OpSGreaterThanEqual:
      return as_signed(a) >= as_signed(b);
    default:
      return std::nullopt;
  }
}

Word compute(Op op, std::uint32_t a, std::uint32_t b) {
  switch (op) {
    case Op::OpBitwiseOr:
    case Op::OpLogicalOr:
      return a | b;
    case Op::OpBitwiseAnd:
    case Op::OpLogicalAnd:
      return a & b;
    case Op::OpBitwiseXor:
      return a ^ b;
    case Op::OpIAdd:
      return a + b;
    case Op::OpISub:
      return a - b;
    case Op::OpIMul:
      return a * b;
    case Op::OpUDiv:
    case Op::OpUMod:
    case Op::OpSDiv:
    case Op::OpSRem:
    case Op::OpSMod:
      return divide(op, a, b);
    case Op::OpShiftLeftLogical:
      return b < 32 ? Word(a << b) : std::nullopt;
    case Op::OpShiftRightLogical:
      return b < 32 ? Word(a >> b) : std::nullopt;
    case Op::OpShiftRightArithmetic:
      return b < 32 ? Word(static_cast<std::uint32_t>(as_signed(a) >> b)) : std::nullopt;
    default:
      return compare(op, a, b);
  }
}

Word compute(Op op, std::uint32_t a) {
  switch (op) {
    case Op::OpSNegate:
      return 0u - a;
    case Op::OpNot:
      return ~a;
    case Op::OpLogicalNot:
      return a ^ 1u;
    default:
      return std::nullopt;
  }
}

bool is_unary(Op op) { return op == Op::OpSNegate || op == Op::OpNot || op == Op::OpLogicalNot; }

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
  const bool is_given = given != specializations_.end();
  switch (constant.op()) {
    case Op::OpSpecConstantTrue:
      return !is_given || given->second != 0;
    case Op::OpSpecConstantFalse:
      return is_given && given->second != 0;
    default:
      return is_given ? given->second : constant.operand(0);
  }
}

// Values of another width would wrap elsewhere.
bool ValueTracer::is_word(Id type) const {
  const Instruction* const declared = module_.definition(type);
  return declared != nullptr && (declared->op() == Op::OpTypeBool ||
                                 (declared->op() == Op::OpTypeInt && declared->operand(0) == 32));
}

ValueTracer::Step ValueTracer::evaluate_operation(const Instruction& instruction, Op op,
                                                  std::size_t first, int& steps) const {
  const auto operand = [&](std::size_t i) -> Step {
    const bool there = first + i < instruction.operand_count() &&
                       is_word(module_.type_of(instruction.operand(first + i)));
    return there ? evaluate(instruction.operand(first + i), steps) : std::nullopt;
  };
  if (op == Op::OpCompositeExtract) {
    return evaluate_extract(instruction, first, steps);
  }
  if (!is_word(instruction.type())) {
    return std::nullopt;
  }
  const Step a = operand(0);
  if (!a) {
    return std::nullopt;
  }
  if (op == Op::OpSelect) {
    return operand(*a != 0 ? 1 : 2);
  }
  if (is_unary(op)) {
    return compute(op, *a);
  }
  const Step b = operand(1);
  return b ? compute(op, *a, *b) : std::nullopt;
}

ValueTracer::Step ValueTracer::evaluate_extract(const Instruction& instruction, std::size_t first,
                                                int& steps) const {
  const bool one_index = instruction.operand_count() == first + 2;
  const Instruction* const whole =
      one_index ? module_.definition(instruction.operand(first)) : nullptr;
  const bool is_list = whole != nullptr && (whole->op() == Op::OpConstantComposite ||
                                            whole->op() == Op::OpSpecConstantComposite);
  const std::uint32_t index = one_index ? instruction.operand(first + 1) : 0;
  return is_list && index < whole->operand_count() ? evaluate(whole->operand(index), steps)
                                                   : std::nullopt;
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
    case Op::OpConstantFalse:
      return 0u;
    case Op::OpConstantTrue:
      return 1u;
    case Op::OpSpecConstant:
    case Op::OpSpecConstantTrue:
    case Op::OpSpecConstantFalse:
      return specialized(*defined);
    case Op::OpSpecConstantOp:
      return specialize_
                 ? evaluate_operation(*defined, static_cast<Op>(defined->operand(0)), 1, steps)
                 : std::nullopt;
    case Op::OpCopyObject:
    case Op::OpBitcast:
      return evaluate(defined->operand(0), steps);
    case Op::OpFunctionParameter:
      return agreed(arguments(value), [&](Id a) { return evaluate(a, steps); });
    case Op::OpLoad:
      return evaluate_load(defined->operand(0), steps);
    default:
      return evaluate_operation(*defined, defined->op(), 0, steps);
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
