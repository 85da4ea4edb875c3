// Find-or-create for the types and constants that inserted code needs. SPIR-V forbids two
// declarations of one non-aggregate type, so what the module already has must be used.
#pragma once

#include <initializer_list>
#include <map>
#include <unordered_map>
#include <vector>

#include "spirv/module.h"

namespace a2rt::spirv {

class TypePool {
 public:
  explicit TypePool(const Module& module);

  Id fresh_id() { return next_id_++; }
  std::uint32_t bound() const { return next_id_; }

  Id void_type() { return type(spv::Op::OpTypeVoid, {}); }
  Id bool_type() { return type(spv::Op::OpTypeBool, {}); }
  Id uint_type() { return type(spv::Op::OpTypeInt, {32, 0}); }
  Id float_type() { return type(spv::Op::OpTypeFloat, {32}); }
  Id vector_type(Id component, std::uint32_t count) {
    return type(spv::Op::OpTypeVector, {component, count});
  }
  Id uvec_type(std::uint32_t count) { return vector_type(uint_type(), count); }
  Id pointer_type(spv::StorageClass storage, Id pointee) {
    return type(spv::Op::OpTypePointer, {static_cast<std::uint32_t>(storage), pointee});
  }
  Id function_type(Id result, const std::vector<Id>& parameters);
  // void f(parameters)
  Id procedure_type(const std::vector<Id>& parameters = {}) {
    return function_type(void_type(), parameters);
  }
  // A new array or struct, which is never another's even if it looks the same.
  Id new_aggregate(spv::Op op, const std::vector<std::uint32_t>& operands);
  // A new struct whose one member is an unbounded array of `element`, laid out with `stride`.
  Id unbounded_block(Id element, std::uint32_t stride);

  Id constant(std::uint32_t value);
  Id composite(Id type, const std::vector<std::uint32_t>& values);

  // A new module-scope variable; `initializer` 0 = none.
  Id variable(spv::StorageClass storage, Id pointee, Id initializer = 0);
  void decorate(Id target, spv::Decoration decoration,
                std::initializer_list<std::uint32_t> literals = {});

  // Type of a value of the module or of one made here or noted with note_type().
  Id type_of(Id value) const;
  void note_type(Id value, Id type) { new_types_.emplace(value, type); }
  // Pointee of the type of pointer `value`; 0 if it is no pointer.
  Id pointee_of(Id value) const;

  const Module& module() const { return module_; }
  const std::vector<Instruction>& new_globals() const { return new_globals_; }
  const std::vector<Instruction>& new_decorations() const { return new_decorations_; }

 private:
  using Key = std::vector<std::uint32_t>;  // opcode, type (or 0), operands

  Id type(spv::Op op, std::initializer_list<std::uint32_t> operands);
  Id find_or_create(spv::Op op, Id result_type, std::span<const std::uint32_t> operands);

  const Module& module_;
  std::uint32_t next_id_;
  std::map<Key, Id> known_;
  std::unordered_map<Id, Id> new_types_;
  std::unordered_map<Id, Id> new_pointees_;  // pointer type -> pointee
  std::vector<Instruction> new_globals_;
  std::vector<Instruction> new_decorations_;
};

}  // namespace a2rt::spirv
