#include "spirv/verdicts.h"

#include <cstddef>

namespace a2rt::spirv {

using capture::RecordHeader;
using capture::VerdictAction;
using capture::VerdictEntry;
using spv::Op;

static_assert(offsetof(RecordHeader, verdict_index) == 32 &&
              offsetof(RecordHeader, verdicts) == 40);
static_assert(offsetof(VerdictEntry, action) == 0 && offsetof(VerdictEntry, tmin) == 4 &&
              offsetof(VerdictEntry, tmax) == 8);

RayArguments apply_verdict(CodeBuilder& code, const RecordWriter& writer, const RecordSite& site,
                           const RayArguments& program) {
  const Id zero = code.constant(0);
  const Id one = code.constant(1);
  const Id low = code.constant(writer.header_low());
  const Id high = code.constant(writer.header_high());
  constexpr std::uint32_t kTablesUnit = offsetof(RecordHeader, verdict_index) / capture::kUnitBytes;
  const Id tables = writer.load_unit(code, writer.header(code), code.constant(kTablesUnit));

  // Loads are not guarded by branches, so where there is nothing to look up they read the header,
  // which always exists, and the value is dropped.
  const Id covered = code.compare(Op::OpULessThan, site.launch, site.verdict_launches);
  const Id index_low = code.select(covered, code.component(tables, 0), low);
  const Id index_high = code.select(covered, code.component(tables, 1), high);
  const Id index = writer.words_at(code, index_low, index_high);
  const Id slot = code.select(covered, code.binary(Op::OpIAdd, site.launch, site.launch), zero);
  const Id first = writer.load_word(code, index, slot);
  const Id count = writer.load_word(code, index, code.binary(Op::OpIAdd, slot, one));

  const Id listed =
      code.compare(Op::OpLogicalAnd, covered, code.compare(Op::OpULessThan, site.ordinal, count));
  const Id entry_low = code.select(listed, code.component(tables, 2), low);
  const Id entry_high = code.select(listed, code.component(tables, 3), high);
  const Id entries = writer.units_at(code, entry_low, entry_high);
  const Id entry = writer.load_unit(
      code, entries, code.select(listed, code.binary(Op::OpIAdd, first, site.ordinal), zero));
  const Id action = code.select(listed, code.component(entry, 0), zero);

  const auto is = [&](VerdictAction wanted) {
    return code.compare(Op::OpIEqual, action, code.constant(static_cast<std::uint32_t>(wanted)));
  };
  const Id miss = is(VerdictAction::kForceMiss);
  const Id interval = is(VerdictAction::kInterval);
  RayArguments bent;
  bent.mask = code.select(miss, zero, program.mask);
  bent.tmin = code.select(interval, code.as_float(code.component(entry, 1)), program.tmin);
  bent.tmax = code.select(interval, code.as_float(code.component(entry, 2)), program.tmax);
  bent.overridden = code.select(code.compare(Op::OpLogicalOr, miss, interval), one, zero);
  return bent;
}

}  // namespace a2rt::spirv
