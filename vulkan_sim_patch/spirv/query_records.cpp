#include "spirv/query_records.h"

#include <utility>

namespace a2rt::spirv {
namespace {

using capture::AnyHitVerdict;
using capture::RecordKind;
using spv::Op;

constexpr std::uint32_t kCommittedTriangle = 1;

// Reads one property after another of the candidate (0) or committed (1) intersection.
class QueryReader {
 public:
  QueryReader(CodeBuilder& code, Id query, spv::RayQueryIntersection which)
      : code_(code), query_(query), which_(code.constant(static_cast<std::uint32_t>(which))) {}

  Id word(Op getter) { return get(getter, code_.types().uint_type()); }
  Id t() {
    return code_.as_uint(get(Op::OpRayQueryGetIntersectionTKHR, code_.types().float_type()));
  }
  Id flag(Op getter) {
    return code_.select(get(getter, code_.types().bool_type()), code_.constant(1),
                        code_.constant(0));
  }

 private:
  Id get(Op getter, Id type) { return code_.emit(getter, type, {query_, which_}); }

  CodeBuilder& code_;
  Id query_;
  Id which_;
};

}  // namespace

bool QueryRecords::is_constant(Id id) const {
  const Instruction* const defined = types_.module().definition(id);
  return defined != nullptr && defined->op() == Op::OpConstant;
}

void QueryRecords::begin(CodeBuilder& code, const Instruction& initialize, Id count) {
  ordinals_.store(code, query_path(types_.module(), initialize.operand(0), initialize), count);
}

void QueryRecords::put_step(CodeBuilder& code, const Instruction& proceed) {
  const QueryPath path = query_path(types_.module(), proceed.operand(0), proceed);
  std::vector<Id> call{step_function(path), path.base};
  for (const Id index : path.indices) {
    if (!is_constant(index)) {
      call.push_back(index);
    }
  }
  call.push_back(ordinals_.load(code, path));
  call.push_back(proceed.result());
  code.emit(Op::OpFunctionCall, types_.void_type(), call);
}

Id QueryRecords::step_function(const QueryPath& path) {
  const Module& module = types_.module();
  std::vector<Id> parameters{module.type_of(path.base)};
  Key key{path.element_pointer, parameters[0]};
  for (const Id index : path.indices) {
    key.push_back(is_constant(index) ? index : module.type_of(index));
    if (!is_constant(index)) {
      parameters.push_back(module.type_of(index));
    }
  }
  parameters.push_back(types_.uint_type());
  parameters.push_back(types_.bool_type());
  const auto [known, fresh] = functions_.emplace(key, 0);
  if (!fresh) {
    return known->second;
  }
  known->second = types_.fresh_id();
  CodeBuilder code(types_);
  code.add(Instruction(Op::OpFunction, std::vector{types_.void_type(), known->second, 0u,
                                                   types_.procedure_type(parameters)}));
  std::vector<Id> arguments;
  for (const Id type : parameters) {
    arguments.push_back(code.emit(Op::OpFunctionParameter, type, {}));
  }
  const Id label = types_.fresh_id();
  code.add(Instruction(Op::OpLabel, std::vector{label}));
  Id query = arguments[0];
  if (path.element_pointer != 0) {
    std::vector<Id> chain{query};
    std::size_t next = 1;
    for (const Id index : path.indices) {
      chain.push_back(is_constant(index) ? index : arguments[next++]);
    }
    query = code.emit(Op::OpAccessChain, path.element_pointer, chain);
  }
  write_step(code, {query, arguments[arguments.size() - 2], arguments.back()}, label);
  code.add(Instruction(Op::OpReturn, std::vector<std::uint32_t>{}));
  code.add(Instruction(Op::OpFunctionEnd, std::vector<std::uint32_t>{}));
  code_.push_back(code.take());
  return known->second;
}

void QueryRecords::write_step(CodeBuilder& code, const Step& step, Id entry_label) const {
  QueryReader committed(code, step.query,
                        spv::RayQueryIntersection::RayQueryCommittedIntersectionKHR);
  const Id zero = code.constant(0);
  const Id type = committed.word(Op::OpRayQueryGetIntersectionTypeKHR);
  const Id exists = code.compare(Op::OpINotEqual, type, zero);
  const Id hit_label = types_.fresh_id();
  const Id merge_label = types_.fresh_id();
  code.add(Instruction(Op::OpSelectionMerge, std::vector{merge_label, 0u}));
  code.add(Instruction(Op::OpBranchConditional, std::vector{exists, hit_label, merge_label}));

  code.add(Instruction(Op::OpLabel, std::vector{hit_label}));
  const Id is_triangle = code.compare(Op::OpIEqual, type, code.constant(kCommittedTriangle));
  const Id front = committed.flag(Op::OpRayQueryGetIntersectionFrontFaceKHR);
  const Id hit = code.uvec4(type, committed.t(),
                            committed.word(Op::OpRayQueryGetIntersectionPrimitiveIndexKHR),
                            committed.word(Op::OpRayQueryGetIntersectionInstanceIdKHR));
  const Id place_of_hit =
      code.uvec4(committed.word(Op::OpRayQueryGetIntersectionGeometryIndexKHR),
                 committed.word(Op::OpRayQueryGetIntersectionInstanceCustomIndexKHR), zero,
                 code.select(is_triangle, front, zero));
  code.add(Instruction(Op::OpBranch, std::vector{merge_label}));

  code.add(Instruction(Op::OpLabel, std::vector{merge_label}));
  const Id uvec4 = types_.uvec_type(4);
  const Id none = types_.composite(uvec4, {0, 0, 0, 0});
  const Id first = code.emit(Op::OpPhi, uvec4, {hit, hit_label, none, entry_label});
  const Id second = code.emit(Op::OpPhi, uvec4, {place_of_hit, hit_label, none, entry_label});
  RecordSite site = writer_.begin(code);
  site.ordinal = step.ordinal;
  writer_.append(code, site, RecordKind::kQueryStep,
                 {first, code.uvec4(code.component(second, 0), code.component(second, 1),
                                    code.select(step.more, code.constant(1), zero),
                                    code.component(second, 3))});
}

void QueryRecords::put_verdict(CodeBuilder& code, const Instruction& instruction) {
  const bool terminates = instruction.op() == Op::OpRayQueryTerminateKHR;
  const AnyHitVerdict verdict = terminates ? AnyHitVerdict::kTerminate : AnyHitVerdict::kAccept;
  const Id flag = code.constant(static_cast<std::uint32_t>(verdict));
  const Id zero = code.constant(0);
  Id first = types_.composite(types_.uvec_type(4), {0, 0, 0, 0});
  Id second = code.uvec4(zero, zero, flag, zero);
  // A query may be terminated without a candidate; then there is nothing to ask for.
  if (!terminates) {
    QueryReader candidate(code, instruction.operand(0),
                          spv::RayQueryIntersection::RayQueryCandidateIntersectionKHR);
    const bool generates = instruction.op() == Op::OpRayQueryGenerateIntersectionKHR;
    const Id t = generates ? code.as_uint(instruction.operand(1), &instruction) : candidate.t();
    first = code.uvec4(candidate.word(Op::OpRayQueryGetIntersectionTypeKHR), t,
                       candidate.word(Op::OpRayQueryGetIntersectionPrimitiveIndexKHR),
                       candidate.word(Op::OpRayQueryGetIntersectionInstanceIdKHR));
    second =
        code.uvec4(candidate.word(Op::OpRayQueryGetIntersectionGeometryIndexKHR),
                   candidate.word(Op::OpRayQueryGetIntersectionInstanceCustomIndexKHR), flag, zero);
  }
  RecordSite site = writer_.begin(code);
  site.ordinal =
      ordinals_.load(code, query_path(types_.module(), instruction.operand(0), instruction));
  writer_.append(code, site, RecordKind::kQueryVerdict, {first, second});
}

std::vector<std::vector<Instruction>> QueryRecords::take_functions() {
  return std::exchange(code_, {});
}

}  // namespace a2rt::spirv
