#include "spirv/types.h"

namespace a2rt::spirv {
namespace {

bool is_shareable(spv::Op op) {
  switch (op) {
    case spv::Op::OpTypeVoid:
    case spv::Op::OpTypeBool:
    case spv::Op::OpTypeInt:
    case spv::Op::OpTypeFloat:
    case spv::Op::OpTypeVector:
    case spv::Op::OpTypePointer:
    case spv::Op::OpTypeFunction:
    case spv::Op::OpConstant:
    case spv::Op::OpConstantComposite:
      return true;
    default:
      return false;
  }
}

}  // namespace

TypePool::TypePool(const Module& module) : module_(module), next_id_(module.bound()) {
  for (const Instruction& instruction : module.globals()) {
    if (is_shareable(instruction.op())) {
      Key key{static_cast<std::uint32_t>(instruction.op()), instruction.type()};
      key.insert(key.end(), instruction.operands().begin(), instruction.operands().end());
      known_.emplace(std::move(key), instruction.result());
    }
  }
}

Id TypePool::find_or_create(spv::Op op, Id result_type, std::span<const std::uint32_t> operands) {
  Key key{static_cast<std::uint32_t>(op), result_type};
  key.insert(key.end(), operands.begin(), operands.end());
  const auto found = known_.find(key);
  if (found != known_.end()) {
    return found->second;
  }
  const Id id = fresh_id();
  std::vector<std::uint32_t> words;
  if (result_type != 0) {
    words.push_back(result_type);
    note_type(id, result_type);
  }
  words.push_back(id);
  words.insert(words.end(), operands.begin(), operands.end());
  new_globals_.emplace_back(op, words);
  known_.emplace(std::move(key), id);
  return id;
}

Id TypePool::type(spv::Op op, std::initializer_list<std::uint32_t> operands) {
  const Id id = find_or_create(op, 0, {operands.begin(), operands.size()});
  if (op == spv::Op::OpTypePointer) {
    new_pointees_.emplace(id, operands.begin()[1]);
  }
  return id;
}

Id TypePool::function_type(Id result, const std::vector<Id>& parameters) {
  std::vector<Id> signature{result};
  signature.insert(signature.end(), parameters.begin(), parameters.end());
  return find_or_create(spv::Op::OpTypeFunction, 0, signature);
}

Id TypePool::new_aggregate(spv::Op op, const std::vector<std::uint32_t>& operands) {
  const Id id = fresh_id();
  std::vector<std::uint32_t> words{id};
  words.insert(words.end(), operands.begin(), operands.end());
  new_globals_.emplace_back(op, words);
  return id;
}

Id TypePool::unbounded_block(Id element, std::uint32_t stride) {
  const Id array = fresh_id();
  const Id block = fresh_id();
  new_globals_.emplace_back(spv::Op::OpTypeRuntimeArray,
                            std::vector<std::uint32_t>{array, element});
  new_globals_.emplace_back(spv::Op::OpTypeStruct, std::vector<std::uint32_t>{block, array});
  decorate(array, spv::Decoration::ArrayStride, {stride});
  decorate(block, spv::Decoration::Block);
  constexpr auto kOffset = static_cast<std::uint32_t>(spv::Decoration::Offset);
  new_decorations_.emplace_back(spv::Op::OpMemberDecorate,
                                std::vector<std::uint32_t>{block, 0, kOffset, 0});
  return block;
}

Id TypePool::constant(std::uint32_t value) {
  const std::uint32_t operands[] = {value};
  return find_or_create(spv::Op::OpConstant, uint_type(), operands);
}

Id TypePool::composite(Id type, const std::vector<std::uint32_t>& values) {
  std::vector<std::uint32_t> parts;
  parts.reserve(values.size());
  for (const std::uint32_t value : values) {
    parts.push_back(constant(value));
  }
  return find_or_create(spv::Op::OpConstantComposite, type, parts);
}

Id TypePool::variable(spv::StorageClass storage, Id pointee, Id initializer) {
  const Id pointer = pointer_type(storage, pointee);
  const Id id = fresh_id();
  std::vector<std::uint32_t> words{pointer, id, static_cast<std::uint32_t>(storage)};
  if (initializer != 0) {
    words.push_back(initializer);
  }
  new_globals_.emplace_back(spv::Op::OpVariable, words);
  note_type(id, pointer);
  return id;
}

void TypePool::decorate(Id target, spv::Decoration decoration,
                        std::initializer_list<std::uint32_t> literals) {
  std::vector<std::uint32_t> words{target, static_cast<std::uint32_t>(decoration)};
  words.insert(words.end(), literals);
  new_decorations_.emplace_back(spv::Op::OpDecorate, words);
}

Id TypePool::type_of(Id value) const {
  const auto found = new_types_.find(value);
  return found != new_types_.end() ? found->second : module_.type_of(value);
}

Id TypePool::pointee_of(Id value) const {
  const Id type = type_of(value);
  const auto found = new_pointees_.find(type);
  if (found != new_pointees_.end()) {
    return found->second;
  }
  const Instruction* const declared = module_.definition(type);
  return declared != nullptr && declared->op() == spv::Op::OpTypePointer ? declared->operand(1) : 0;
}

}  // namespace a2rt::spirv
