#include "spirv/entry_inputs.h"

namespace a2rt::spirv {

BuiltinPool::BuiltinPool(TypePool& types) : types_(types) {
  constexpr auto kBuiltIn = static_cast<std::uint32_t>(spv::Decoration::BuiltIn);
  for (const Instruction& instruction : types.module().globals()) {
    if (instruction.op() != spv::Op::OpDecorate || instruction.operand_count() < 3 ||
        instruction.operand(1) != kBuiltIn) {
      continue;
    }
    const Id target = instruction.operand(0);
    const auto builtin = static_cast<spv::BuiltIn>(instruction.operand(2));
    const Instruction* const defined = types.module().definition(target);
    if (defined == nullptr) {
      continue;
    }
    if (builtin == spv::BuiltIn::WorkgroupSize && defined->op() != spv::Op::OpVariable) {
      workgroup_size_ = target;
    } else if (defined->op() == spv::Op::OpVariable &&
               defined->operand(0) == static_cast<std::uint32_t>(spv::StorageClass::Input)) {
      existing_.emplace(target, builtin);
    }
  }
}

bool BuiltinPool::builtin_of(Id variable, spv::BuiltIn& builtin) const {
  const auto found = existing_.find(variable);
  if (found != existing_.end()) {
    builtin = found->second;
  }
  return found != existing_.end();
}

Id BuiltinPool::made(spv::BuiltIn builtin, Id type) {
  const auto found = made_.find(builtin);
  if (found != made_.end()) {
    return found->second;
  }
  const Id variable = types_.variable(spv::StorageClass::Input, type);
  types_.decorate(variable, spv::Decoration::BuiltIn, {static_cast<std::uint32_t>(builtin)});
  made_.emplace(builtin, variable);
  return variable;
}

EntryInputs::EntryInputs(BuiltinPool& pool, const EntryDeclaration& entry) : pool_(pool) {
  for (const Id variable : entry.interface) {
    spv::BuiltIn builtin{};
    if (pool.builtin_of(variable, builtin)) {
      variables_.emplace(builtin, variable);
    }
  }
}

Id EntryInputs::load(CodeBuilder& code, spv::BuiltIn builtin, Id type) {
  auto found = variables_.find(builtin);
  if (found == variables_.end()) {
    found = variables_.emplace(builtin, pool_.made(builtin, type)).first;
    used_.push_back(found->second);
  }
  const Id pointee = pool_.types().pointee_of(found->second);
  if (pointee == 0) {
    throw SpirvError(0, "builtin variable %" + std::to_string(found->second) + " is no pointer");
  }
  return code.load(pointee, found->second);
}

}  // namespace a2rt::spirv
