#include "spirv/code.h"

namespace a2rt::spirv {
namespace {

constexpr auto kAligned = static_cast<std::uint32_t>(spv::MemoryAccessMask::Aligned);

bool is_word(const Module& module, Id type) {
  const Instruction* const declared = module.definition(type);
  return declared != nullptr && declared->operand_count() > 0 && declared->operand(0) == 32 &&
         (declared->op() == spv::Op::OpTypeInt || declared->op() == spv::Op::OpTypeFloat);
}

[[noreturn]] void refuse(Id value, const Instruction* user, const char* wanted) {
  const std::string reason = "uses %" + std::to_string(value) + ", which is not " + wanted;
  if (user != nullptr) {
    user->fail(reason);
  }
  throw SpirvError(0, "inserted code " + reason);
}

}  // namespace

Id CodeBuilder::emit(spv::Op op, Id type, std::initializer_list<std::uint32_t> operands) {
  return emit(op, type, std::span(operands.begin(), operands.size()));
}

Id CodeBuilder::emit(spv::Op op, Id type, std::span<const std::uint32_t> operands) {
  const Id id = types_.fresh_id();
  std::vector<std::uint32_t> words{type, id};
  words.insert(words.end(), operands.begin(), operands.end());
  code_.emplace_back(op, words);
  types_.note_type(id, type);
  return id;
}

Id CodeBuilder::load_aligned(Id type, Id pointer, std::uint32_t alignment) {
  return emit(spv::Op::OpLoad, type, {pointer, kAligned, alignment});
}

void CodeBuilder::add_store(Id pointer, Id value, std::uint32_t alignment) {
  std::vector<std::uint32_t> words{pointer, value};
  if (alignment != 0) {
    words.insert(words.end(), {kAligned, alignment});
  }
  code_.emplace_back(spv::Op::OpStore, words);
}

Id CodeBuilder::select(Id condition, Id yes, Id no) {
  return emit(spv::Op::OpSelect, types_.type_of(yes), {condition, yes, no});
}

Id CodeBuilder::component(Id vector, std::uint32_t index) {
  return emit(spv::Op::OpCompositeExtract, types_.uint_type(), {vector, index});
}

Id CodeBuilder::uvec4(Id x, Id y, Id z, Id w) {
  return emit(spv::Op::OpCompositeConstruct, types_.uvec_type(4), {x, y, z, w});
}

Id CodeBuilder::as_uint(Id value, const Instruction* user) {
  const Id type = types_.type_of(value);
  if (type == types_.uint_type()) {
    return value;
  }
  // Types made here are int, float, vectors of them; a float made here is 32 bits wide as well.
  if (type != types_.float_type() && !is_word(types_.module(), type)) {
    refuse(value, user, "a 32-bit scalar");
  }
  return emit(spv::Op::OpBitcast, types_.uint_type(), {value});
}

Id CodeBuilder::as_uvec3(Id value, const Instruction* user) {
  const Id type = types_.type_of(value);
  const Id target = types_.uvec_type(3);
  if (type == target) {
    return value;
  }
  const Instruction* const declared = types_.module().definition(type);
  const bool made_here = type != 0 && type == types_.vector_type(types_.float_type(), 3);
  const bool fits = declared != nullptr && declared->op() == spv::Op::OpTypeVector &&
                    declared->operand(1) == 3 && is_word(types_.module(), declared->operand(0));
  if (!made_here && !fits) {
    refuse(value, user, "a vector of three 32-bit numbers");
  }
  return emit(spv::Op::OpBitcast, target, {value});
}

}  // namespace a2rt::spirv
