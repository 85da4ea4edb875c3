#include "spirv/entry_wrapper.h"

#include <cstddef>

namespace a2rt::spirv {
namespace {

using capture::RecordKind;
using capture::Stage;
using spv::BuiltIn;
using spv::Op;

// x + width * (y + height * z)
Id linear(CodeBuilder& code, Id position, Id width, Id height) {
  const Id z = code.binary(Op::OpIMul, height, code.component(position, 2));
  const Id yz = code.binary(Op::OpIAdd, z, code.component(position, 1));
  return code.binary(Op::OpIAdd, code.binary(Op::OpIMul, yz, width), code.component(position, 0));
}

// Width and height of a workgroup: the decorated constant wins over the execution modes.
std::array<Id, 2> workgroup_size(CodeBuilder& code, const EntryDeclaration& entry, Id decorated) {
  if (decorated != 0) {
    const Id size = code.as_uvec3(decorated, entry.instruction);
    return {code.component(size, 0), code.component(size, 1)};
  }
  for (const Instruction& mode : code.types().module().globals()) {
    const bool is_literal =
        mode.op() == Op::OpExecutionMode && mode.operand_count() >= 5 &&
        mode.operand(1) == static_cast<std::uint32_t>(spv::ExecutionMode::LocalSize);
    const bool is_id =
        mode.op() == Op::OpExecutionModeId && mode.operand_count() >= 5 &&
        mode.operand(1) == static_cast<std::uint32_t>(spv::ExecutionMode::LocalSizeId);
    if ((is_literal || is_id) && mode.operand(0) == entry.function) {
      const auto size = [&](std::size_t i) {
        return is_literal ? code.constant(mode.operand(i)) : code.as_uint(mode.operand(i), &mode);
      };
      return {size(2), size(3)};
    }
  }
  entry.instruction->fail("declares no workgroup size");
}

Id compute_launch(CodeBuilder& code, EntryInputs& inputs, const EntryDeclaration& entry,
                  Id decorated_size) {
  const Id uvec3 = code.types().uvec_type(3);
  const Id position =
      code.as_uvec3(inputs.load(code, BuiltIn::GlobalInvocationId, uvec3), entry.instruction);
  const Id groups =
      code.as_uvec3(inputs.load(code, BuiltIn::NumWorkgroups, uvec3), entry.instruction);
  const auto size = workgroup_size(code, entry, decorated_size);
  const Id width = code.binary(Op::OpIMul, code.component(groups, 0), size[0]);
  const Id height = code.binary(Op::OpIMul, code.component(groups, 1), size[1]);
  return linear(code, position, width, height);
}

Id ray_tracing_launch(CodeBuilder& code, EntryInputs& inputs, const EntryDeclaration& entry) {
  const Id uvec3 = code.types().uvec_type(3);
  const Id position =
      code.as_uvec3(inputs.load(code, BuiltIn::LaunchIdKHR, uvec3), entry.instruction);
  const Id size =
      code.as_uvec3(inputs.load(code, BuiltIn::LaunchSizeKHR, uvec3), entry.instruction);
  return linear(code, position, code.component(size, 0), code.component(size, 1));
}

Id fragment_launch(CodeBuilder& code, EntryInputs& inputs, const RecordWriter& writer,
                   const EntryDeclaration& entry) {
  TypePool& types = code.types();
  const Id vec4 = types.vector_type(types.float_type(), 4);
  const Id position = inputs.load(code, BuiltIn::FragCoord, vec4);
  if (types.type_of(position) != vec4) {
    entry.instruction->fail("has a FragCoord that is not a vector of four 32-bit floats");
  }
  const auto pixel = [&](std::uint32_t axis) {
    const Id value = code.emit(Op::OpCompositeExtract, types.float_type(), {position, axis});
    return code.emit(Op::OpConvertFToU, types.uint_type(), {value});
  };
  const Id x = pixel(0);
  const Id y = pixel(1);
  constexpr std::uint32_t kWord = offsetof(capture::RecordHeader, launch_width) / 4;
  const Id header = writer.words_at(code, code.constant(writer.header_low()),
                                    code.constant(writer.header_high()));
  const Id width = writer.load_word(code, header, code.constant(kWord));
  return code.binary(Op::OpIAdd, code.binary(Op::OpIMul, y, width), x);
}

void enter(CodeBuilder& code, const Instrumentation& shared, EntryInputs& inputs, Stage stage) {
  const RecordWriter& writer = shared.writer;
  const InstrumentOptions& options = shared.options;
  const bool starts_launch = stage == Stage::kRayGeneration || stage == Stage::kCompute;
  if (starts_launch && shared.keeps_ordinals()) {
    writer.reset_ordinal(code, writer.begin(code));
  }
  if (stage == Stage::kClosestHit && options.results) {
    const HitWords hit = HitData::read_inputs(code, inputs, true);
    HitData::append(code, writer, writer.begin(code), RecordKind::kHit, hit, code.constant(0));
  }
  if (stage == Stage::kMiss && options.results) {
    writer.append(code, writer.begin(code), RecordKind::kMiss, {});
  }
  const bool has_candidate = stage == Stage::kAnyHit || stage == Stage::kIntersection;
  if (has_candidate && options.candidates) {
    shared.hits.keep(code, HitData::read_inputs(code, inputs, stage == Stage::kAnyHit));
  }
}

void require_procedure(const Module& module, const EntryDeclaration& entry) {
  const Instruction* const function = module.definition(entry.function);
  const Instruction* const type =
      function == nullptr ? nullptr : module.definition(function->operand(1));
  const bool fits = type != nullptr && type->op() == Op::OpTypeFunction &&
                    type->operand_count() == 1 &&
                    module.type_op(type->operand(0)) == Op::OpTypeVoid;
  if (!fits) {
    entry.instruction->fail("names a function that is not void without parameters");
  }
}

// Starts a void function without parameters and gives back its id.
Id begin_procedure(CodeBuilder& code) {
  TypePool& types = code.types();
  const Id function = types.fresh_id();
  code.add(Instruction(Op::OpFunction,
                       std::vector{types.void_type(), function, 0u, types.procedure_type()}));
  code.add(Instruction(Op::OpLabel, std::vector{types.fresh_id()}));
  return function;
}

void end_procedure(CodeBuilder& code) {
  code.add(Instruction(Op::OpReturn, std::vector<std::uint32_t>{}));
  code.add(Instruction(Op::OpFunctionEnd, std::vector<std::uint32_t>{}));
}

}  // namespace

EntryWrapper wrap_silent_entry(const EntryDeclaration& entry, const Instrumentation& shared,
                               TypePool& types) {
  require_procedure(types.module(), entry);
  EntryWrapper wrapper;
  CodeBuilder code(types);
  wrapper.function = begin_procedure(code);
  shared.writer.enter(code, Stage::kOther, 0, code.constant(UINT32_MAX), false);
  code.emit(Op::OpFunctionCall, types.void_type(), {entry.function});
  end_procedure(code);
  wrapper.code = code.take();
  return wrapper;
}

EntryWrapper wrap_entry(const EntryDeclaration& entry, const Instrumentation& shared,
                        BuiltinPool& builtins, std::uint32_t shader) {
  TypePool& types = builtins.types();
  require_procedure(types.module(), entry);
  const Stage stage = stage_of(entry.model);
  EntryInputs inputs(builtins, entry);
  EntryWrapper wrapper;
  CodeBuilder code(types);
  wrapper.function = begin_procedure(code);
  const Id launch =
      stage == Stage::kCompute    ? compute_launch(code, inputs, entry, builtins.workgroup_size())
      : stage == Stage::kFragment ? fragment_launch(code, inputs, shared.writer, entry)
                                  : ray_tracing_launch(code, inputs, entry);
  shared.writer.enter(code, stage, shader, launch, true);
  shared.counters.clear(code);
  enter(code, shared, inputs, stage);
  code.emit(Op::OpFunctionCall, types.void_type(), {entry.function});
  if (stage == Stage::kAnyHit) {
    put_any_hit(code, shared, capture::AnyHitVerdict::kAccept);
  }
  put_end(code, shared);
  end_procedure(code);
  wrapper.code = code.take();
  wrapper.inputs = inputs.used();
  return wrapper;
}

}  // namespace a2rt::spirv
