#include "spirv/function_pass.h"

#include "spirv/verdicts.h"

namespace a2rt::spirv {
namespace {

using capture::AnyHitVerdict;
using capture::RecordKind;
using spv::Op;

// Positions of the operands of the two trace instructions.
struct TraceOperands {
  std::size_t flags, mask, origin, tmin, direction, tmax;
};
constexpr TraceOperands kTraceRay{1, 2, 6, 7, 8, 9};
constexpr TraceOperands kQueryInitialize{2, 3, 4, 5, 6, 7};
constexpr std::size_t kSbtOffset = 3, kSbtStride = 4, kMissIndex = 5;  // of OpTraceRayKHR

bool is_terminator(Op op) {
  switch (op) {
    case Op::OpBranch:
    case Op::OpBranchConditional:
    case Op::OpSwitch:
    case Op::OpKill:
    case Op::OpReturn:
    case Op::OpReturnValue:
    case Op::OpUnreachable:
    case Op::OpTerminateInvocation:
    case Op::OpIgnoreIntersectionKHR:
    case Op::OpTerminateRayKHR:
      return true;
    default:
      return false;
  }
}

// Where a block's last instructions begin: its merge instruction, or else its terminator. A block
// whose terminator is an opcode this build does not know ends with its last instruction.
std::size_t tail_begin(std::span<const Instruction> code) {
  std::size_t at = code.size() - 1;
  for (std::size_t i = code.size(); i > 0; --i) {
    if (is_terminator(code[i - 1].op())) {
      at = i - 1;
      break;
    }
  }
  std::size_t merge = at;
  while (merge > 1 && is_debug_line(code[merge - 1])) {
    --merge;
  }
  const bool has_merge = merge > 1 && (code[merge - 1].op() == Op::OpSelectionMerge ||
                                       code[merge - 1].op() == Op::OpLoopMerge);
  return has_merge ? merge - 1 : at;
}

// mask | sbt_offset << 8 | sbt_stride << 12 | miss_index << 16, of what the driver looks at.
Id packed_arguments(CodeBuilder& code, const Instruction& trace, Id mask) {
  Id packed = code.binary(Op::OpBitwiseAnd, mask, code.constant(0xff));
  if (trace.op() != Op::OpTraceRayKHR) {
    return packed;
  }
  const auto add = [&](std::size_t operand, std::uint32_t bits, std::uint32_t shift) {
    const Id value = code.binary(Op::OpBitwiseAnd, code.as_uint(trace.operand(operand), &trace),
                                 code.constant(bits));
    packed = code.binary(Op::OpBitwiseOr, packed,
                         code.binary(Op::OpShiftLeftLogical, value, code.constant(shift)));
  };
  add(kSbtOffset, 0xf, 8);
  add(kSbtStride, 0xf, 12);
  add(kMissIndex, 0xffff, 16);
  return packed;
}

Id with_w(CodeBuilder& code, Id uvec3, Id w) {
  return code.uvec4(code.component(uvec3, 0), code.component(uvec3, 1), code.component(uvec3, 2),
                    w);
}

// A record of the counters alone, if they are on.
void put_counters(CodeBuilder& code, const Instrumentation& shared, RecordKind kind) {
  if (shared.counters.enabled()) {
    const RecordSite site = shared.writer.begin(code);
    const auto counted = shared.counters.take(code);
    shared.writer.append(code, site, kind, {counted[0], counted[1]});
  }
}

}  // namespace

bool is_trace_site(const Instruction& instruction) {
  return instruction.op() == Op::OpTraceRayKHR || instruction.op() == Op::OpRayQueryInitializeKHR;
}

void put_end(CodeBuilder& code, const Instrumentation& shared) {
  put_counters(code, shared, RecordKind::kEnd);
}

void put_any_hit(CodeBuilder& code, const Instrumentation& shared, AnyHitVerdict verdict) {
  if (shared.options.candidates) {
    HitData::append(code, shared.writer, shared.writer.begin(code), RecordKind::kAnyHit,
                    shared.hits.kept(code), code.constant(static_cast<std::uint32_t>(verdict)));
  }
}

std::vector<Instruction> FunctionPass::rewrite(const Function& function) {
  const std::span<const Instruction> code(function.code);
  std::size_t at = 0;
  while (at < code.size() && code[at].op() != Op::OpLabel) {
    copy(code[at++]);
  }
  while (at < code.size() && code[at].op() == Op::OpLabel) {
    std::size_t end = at + 1;
    while (end < code.size() && code[end].op() != Op::OpLabel &&
           code[end].op() != Op::OpFunctionEnd) {
      ++end;
    }
    block(code.subspan(at, end - at));
    at = end;
  }
  for (; at < code.size(); ++at) {
    copy(code[at]);
  }
  return std::move(out_);
}

void FunctionPass::block(std::span<const Instruction> code) {
  pending_ = {};
  copy(code[0]);
  if (code.size() == 1) {
    return;
  }
  const std::size_t tail = tail_begin(code);
  for (std::size_t i = 1; i < tail; ++i) {
    instruction(code[i]);
  }
  leave(code.subspan(tail));
}

void FunctionPass::append_code(CodeBuilder& code) {
  for (Instruction& instruction : code.take()) {
    out_.push_back(std::move(instruction));
  }
}

void FunctionPass::emit_pending() {
  CodeBuilder code(types_);
  shared_.counters.flush(code, pending_);
  append_code(code);
}

void FunctionPass::instruction(const Instruction& original) {
  const InstrumentOptions& options = shared_.options;
  pending_ += shared_.weights.weigh(original);
  CodeBuilder code(types_);
  switch (original.op()) {
    case Op::OpTraceRayKHR:
    case Op::OpRayQueryInitializeKHR:
      trace(original);
      return;
    case Op::OpReportIntersectionKHR:
      report(original);
      return;
    case Op::OpExecuteCallableKHR:
      segment();
      break;
    case Op::OpFunctionCall:
      call(original);
      return;
    case Op::OpRayQueryProceedKHR:
      copy(original);
      if (options.results) {
        shared_.queries.put_step(code, original);
        append_code(code);
      }
      return;
    case Op::OpRayQueryConfirmIntersectionKHR:
    case Op::OpRayQueryGenerateIntersectionKHR:
    case Op::OpRayQueryTerminateKHR:
      if (options.candidates) {
        shared_.queries.put_verdict(code, original);
        append_code(code);
      }
      break;
    case Op::OpDemoteToHelperInvocation:
      // What a helper invocation stores is dropped: this is the last chance.
      emit_pending();
      put_end(code, shared_);
      append_code(code);
      break;
    default:
      break;
  }
  copy(original);
}

void FunctionPass::leave(std::span<const Instruction> tail) {
  CodeBuilder code(types_);
  for (const Instruction& instruction : tail) {
    pending_ += shared_.weights.weigh(instruction);
  }
  const auto ends = [&](Op op) {
    for (const Instruction& instruction : tail) {
      if (instruction.op() == op) {
        return true;
      }
    }
    return false;
  };
  if (!ends(Op::OpUnreachable)) {
    shared_.counters.flush(code, pending_);
  }
  if (ends(Op::OpIgnoreIntersectionKHR)) {
    put_any_hit(code, shared_, AnyHitVerdict::kIgnore);
    put_end(code, shared_);
  } else if (ends(Op::OpTerminateRayKHR)) {
    put_any_hit(code, shared_, AnyHitVerdict::kTerminate);
    put_end(code, shared_);
  } else if (ends(Op::OpKill) || ends(Op::OpTerminateInvocation)) {
    put_end(code, shared_);
  }
  append_code(code);
  for (const Instruction& instruction : tail) {
    copy(instruction);
  }
}

void FunctionPass::segment() {
  if (shared_.counters.enabled()) {
    emit_pending();
    CodeBuilder code(types_);
    put_counters(code, shared_, RecordKind::kSegment);
    append_code(code);
  }
}

void FunctionPass::trace(const Instruction& original) {
  const std::uint32_t number = next_site_++;
  const bool wanted = shared_.keeps_ordinals() && number < shared_.options.site_limit;
  const bool names_query =
      original.op() == Op::OpRayQueryInitializeKHR && shared_.records_queries();
  if (!wanted) {
    CodeBuilder unrecorded(types_);
    if (names_query) {
      shared_.queries.begin(unrecorded, original, unrecorded.constant(0));
    }
    append_code(unrecorded);
    copy(original);
    return;
  }
  emit_pending();
  const TraceOperands at = original.op() == Op::OpTraceRayKHR ? kTraceRay : kQueryInitialize;
  const RecordWriter& writer = shared_.writer;
  CodeBuilder code(types_);
  const RecordSite site = writer.begin(code);
  RayArguments program;
  program.mask = code.as_uint(original.operand(at.mask), &original);
  program.tmin = original.operand(at.tmin);
  program.tmax = original.operand(at.tmax);
  program.overridden = code.constant(0);
  const Id tmin = code.as_uint(program.tmin, &original);
  const Id tmax = code.as_uint(program.tmax, &original);
  const RayArguments bent =
      shared_.options.verdicts ? apply_verdict(code, writer, site, program) : program;
  if (shared_.options.rays) {
    const Id start = with_w(code, code.as_uvec3(original.operand(at.origin), &original), tmin);
    const Id way = with_w(code, code.as_uvec3(original.operand(at.direction), &original), tmax);
    const Id rest = code.uvec4(code.as_uint(original.operand(at.flags), &original),
                               packed_arguments(code, original, program.mask),
                               code.constant(number), bent.overridden);
    const auto counted = shared_.counters.take(code);
    writer.append(code, site, RecordKind::kRay, {start, way, rest, counted[0], counted[1]});
  }
  writer.advance_ordinal(code, site);
  if (names_query) {
    shared_.queries.begin(code, original, code.binary(Op::OpIAdd, site.ordinal, code.constant(1)));
  }
  append_code(code);
  Instruction edited = original;
  if (shared_.options.verdicts) {
    edited.set_operand(at.mask, bent.mask);
    edited.set_operand(at.tmin, bent.tmin);
    edited.set_operand(at.tmax, bent.tmax);
  }
  out_.push_back(std::move(edited));
}

void FunctionPass::call(const Instruction& original) {
  if (shared_.calls.may_flush(original.operand(0))) {
    emit_pending();
  }
  CodeBuilder code(types_);
  if (shared_.records_queries()) {
    shared_.queries.ordinals().hand_over(code, original);
  }
  append_code(code);
  copy(original);
  if (shared_.records_queries()) {
    shared_.queries.ordinals().take_back(code, original);
  }
  append_code(code);
}

void FunctionPass::report(const Instruction& original) {
  // An any-hit shader that terminates the ray also ends this shader inside the instruction, so
  // everything is written before it; only the verdict is corrected afterwards.
  segment();
  if (!shared_.options.candidates) {
    copy(original);
    return;
  }
  CodeBuilder before(types_);
  HitWords hit = shared_.hits.kept(before);
  hit.t = before.as_uint(original.operand(0), &original);
  hit.kind = before.as_uint(original.operand(1), &original);
  const RecordSite site = shared_.writer.begin(before);
  const Id place =
      HitData::append(before, shared_.writer, site, RecordKind::kReport, hit, before.constant(1));
  append_code(before);
  copy(original);
  CodeBuilder after(types_);
  shared_.writer.put_word(after, site, place, 2, 2,
                          after.select(original.result(), after.constant(1), after.constant(0)));
  append_code(after);
}

}  // namespace a2rt::spirv
