// Straight-line code under construction, and the reinterpretation of values as 32-bit words.
#pragma once

#include <initializer_list>
#include <vector>

#include "spirv/types.h"

namespace a2rt::spirv {

class CodeBuilder {
 public:
  explicit CodeBuilder(TypePool& types) : types_(types) {}

  TypePool& types() { return types_; }
  std::vector<Instruction> take() { return std::move(code_); }
  void add(Instruction instruction) { code_.push_back(std::move(instruction)); }

  // An instruction with a result of `type`; gives back the result.
  Id emit(spv::Op op, Id type, std::initializer_list<std::uint32_t> operands);
  Id emit(spv::Op op, Id type, std::span<const std::uint32_t> operands);
  void store(Id pointer, Id value) { add_store(pointer, value, 0); }
  // A store through a physical pointer of known alignment.
  void store_aligned(Id pointer, Id value, std::uint32_t alignment) {
    add_store(pointer, value, alignment);
  }
  Id load(Id type, Id pointer) { return emit(spv::Op::OpLoad, type, {pointer}); }
  Id load_aligned(Id type, Id pointer, std::uint32_t alignment);

  Id constant(std::uint32_t value) { return types_.constant(value); }
  Id binary(spv::Op op, Id a, Id b) { return emit(op, types_.uint_type(), {a, b}); }
  Id compare(spv::Op op, Id a, Id b) { return emit(op, types_.bool_type(), {a, b}); }
  Id select(Id condition, Id yes, Id no);
  Id component(Id vector, std::uint32_t index);  // of a uvec
  Id uvec4(Id x, Id y, Id z, Id w);

  // The bits of a 32-bit scalar, or of a vector of three of them, as unsigned integers.
  // `user` is blamed in the SpirvError if the value has another type.
  Id as_uint(Id value, const Instruction* user = nullptr);
  Id as_uvec3(Id value, const Instruction* user = nullptr);
  Id as_float(Id word) { return emit(spv::Op::OpBitcast, types_.float_type(), {word}); }

 private:
  void add_store(Id pointer, Id value, std::uint32_t alignment);

  TypePool& types_;
  std::vector<Instruction> code_;
};

}  // namespace a2rt::spirv
