#include "spirv/query_records.h"

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

AnyHitVerdict verdict_of(const Instruction& instruction) {
  return instruction.op() == Op::OpRayQueryTerminateKHR ? AnyHitVerdict::kTerminate
                                                        : AnyHitVerdict::kAccept;
}

}  // namespace

void put_query_step(CodeBuilder& code, const RecordWriter& writer, const Instruction& proceed) {
  QueryReader committed(code, proceed.operand(0),
                        spv::RayQueryIntersection::RayQueryCommittedIntersectionKHR);
  const Id zero = code.constant(0);
  const Id type = committed.word(Op::OpRayQueryGetIntersectionTypeKHR);
  const Id exists = code.compare(Op::OpINotEqual, type, zero);
  // Without a committed intersection the getters give undefined values.
  const auto defined = [&](Id value) { return code.select(exists, value, zero); };
  const Id is_triangle = code.compare(Op::OpIEqual, type, code.constant(kCommittedTriangle));
  const Id front = committed.flag(Op::OpRayQueryGetIntersectionFrontFaceKHR);
  const Id more = code.select(proceed.result(), code.constant(1), zero);

  const RecordSite site = writer.begin(code);
  const RecordPlace place =
      writer.open(code, site, RecordKind::kQueryStep, capture::kQueryStepUnits);
  writer.put(code, place, 1,
             code.uvec4(type, defined(committed.t()),
                        defined(committed.word(Op::OpRayQueryGetIntersectionPrimitiveIndexKHR)),
                        defined(committed.word(Op::OpRayQueryGetIntersectionInstanceIdKHR))));
  writer.put(
      code, place, 2,
      code.uvec4(defined(committed.word(Op::OpRayQueryGetIntersectionGeometryIndexKHR)),
                 defined(committed.word(Op::OpRayQueryGetIntersectionInstanceCustomIndexKHR)), more,
                 code.select(is_triangle, front, zero)));
}

void put_query_verdict(CodeBuilder& code, const RecordWriter& writer,
                       const Instruction& instruction) {
  QueryReader candidate(code, instruction.operand(0),
                        spv::RayQueryIntersection::RayQueryCandidateIntersectionKHR);
  const Id type = candidate.word(Op::OpRayQueryGetIntersectionTypeKHR);
  const bool generates = instruction.op() == Op::OpRayQueryGenerateIntersectionKHR;
  const Id t = generates ? code.as_uint(instruction.operand(1), &instruction) : candidate.t();
  const Id verdict = code.constant(static_cast<std::uint32_t>(verdict_of(instruction)));

  const RecordSite site = writer.begin(code);
  const RecordPlace place =
      writer.open(code, site, RecordKind::kQueryVerdict, capture::kQueryVerdictUnits);
  writer.put(code, place, 1,
             code.uvec4(type, t, candidate.word(Op::OpRayQueryGetIntersectionPrimitiveIndexKHR),
                        candidate.word(Op::OpRayQueryGetIntersectionInstanceIdKHR)));
  writer.put(code, place, 2,
             code.uvec4(candidate.word(Op::OpRayQueryGetIntersectionGeometryIndexKHR),
                        candidate.word(Op::OpRayQueryGetIntersectionInstanceCustomIndexKHR),
                        verdict, code.constant(0)));
}

}  // namespace a2rt::spirv
