#include "spirv/append_functions.h"

#include <cstddef>
#include <utility>

#include "spirv/record_writer.h"

namespace a2rt::spirv {
namespace {

using capture::RecordHeader;
using spv::Op;

constexpr std::uint32_t kNoMask = 0;  // of the control operands

void label(CodeBuilder& code, Id id) { code.add(Instruction(Op::OpLabel, std::vector{id})); }
void branch(CodeBuilder& code, Id to) { code.add(Instruction(Op::OpBranch, std::vector{to})); }
void branch_if(CodeBuilder& code, Id condition, Id yes, Id no) {
  code.add(Instruction(Op::OpBranchConditional, std::vector{condition, yes, no}));
}

// units[index], of values that stand in registers.
Id chosen(CodeBuilder& code, const std::vector<Id>& units, Id index) {
  const Id flags = code.types().vector_type(code.types().bool_type(), 4);
  Id value = units[0];
  for (std::uint32_t i = 1; i < units.size(); ++i) {
    const Id is = code.compare(Op::OpIEqual, index, code.constant(i));
    // Before SPIR-V 1.4 vectors are selected by vectors only.
    const Id all = code.emit(Op::OpCompositeConstruct, flags, {is, is, is, is});
    value = code.select(all, units[i], value);
  }
  return value;
}

// Blocks from the current one, which it closes, to a new one: stores all units at `claimed`.
void store_units(CodeBuilder& code, const RecordWriter& writer, const RecordSite& site, Id claimed,
                 const std::vector<Id>& units, Id entry_block, Id next_block) {
  TypePool& types = code.types();
  if (units.size() == 1) {
    writer.put(code, site, claimed, units[0]);
    branch(code, next_block);
    return;
  }
  const Id header = types.fresh_id(), body = types.fresh_id(), more = types.fresh_id();
  const Id next = types.fresh_id();
  branch(code, header);

  label(code, header);
  const Id index =
      code.emit(Op::OpPhi, types.uint_type(), {code.constant(0), entry_block, next, more});
  constexpr auto kKeep = static_cast<std::uint32_t>(spv::LoopControlMask::DontUnroll);
  code.add(Instruction(Op::OpLoopMerge, std::vector{next_block, more, kKeep}));
  branch(code, body);

  label(code, body);
  writer.put(code, site, code.binary(Op::OpIAdd, claimed, index), chosen(code, units, index));
  branch(code, more);

  label(code, more);
  code.add(Instruction(Op::OpIAdd, std::vector{types.uint_type(), next, index, code.constant(1)}));
  const auto count = static_cast<std::uint32_t>(units.size());
  branch_if(code, code.compare(Op::OpULessThan, next, code.constant(count)), header, next_block);
}

std::vector<Instruction> append_function(TypePool& types, const RecordWriter& writer, Id function,
                                         std::uint32_t count) {
  const Id uint = types.uint_type();
  std::vector<Id> parameters{uint, uint};
  parameters.insert(parameters.end(), count - 1, types.uvec_type(4));
  CodeBuilder code(types);
  code.add(Instruction(
      Op::OpFunction, std::vector{uint, function, kNoMask, types.function_type(uint, parameters)}));
  const Id kind = code.emit(Op::OpFunctionParameter, uint, {});
  const Id ordinal = code.emit(Op::OpFunctionParameter, uint, {});
  std::vector<Id> units{0};
  for (std::uint32_t i = 1; i < count; ++i) {
    units.push_back(code.emit(Op::OpFunctionParameter, types.uvec_type(4), {}));
  }
  label(code, types.fresh_id());
  const RecordSite site = writer.context(code);
  units[0] =
      code.uvec4(code.binary(Op::OpBitwiseOr, site.tag, kind), site.launch, site.dispatch, ordinal);
  const RecordWriter::Claim claim = writer.claim(code, site, count);

  const Id store = types.fresh_id(), stored = types.fresh_id(), lose = types.fresh_id();
  const Id end = types.fresh_id();
  code.add(Instruction(Op::OpSelectionMerge, std::vector{end, kNoMask}));
  branch_if(code, claim.fits, store, lose);
  label(code, store);
  store_units(code, writer, site, claim.offset, units, store, stored);
  label(code, stored);
  branch(code, end);
  label(code, lose);
  writer.count_lost(code, site);
  branch(code, end);
  label(code, end);
  code.add(Instruction(Op::OpReturnValue,
                       std::vector{code.select(claim.fits, claim.offset, site.capacity)}));
  code.add(Instruction(Op::OpFunctionEnd, std::vector<std::uint32_t>{}));
  return code.take();
}

}  // namespace

Id AppendFunctions::of(const RecordWriter& writer, std::uint32_t units) {
  const auto [known, fresh] = ids_.emplace(units, 0);
  if (fresh) {
    known->second = types_.fresh_id();
    code_.push_back(append_function(types_, writer, known->second, units));
  }
  return known->second;
}

std::vector<std::vector<Instruction>> AppendFunctions::take() { return std::exchange(code_, {}); }

}  // namespace a2rt::spirv
