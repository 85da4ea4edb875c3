#include "import_records.h"

#include <algorithm>
#include <string>

#include "a2rt/base/error.h"

namespace a2rt::import {
namespace {

using namespace capture;

[[noreturn]] void damaged(std::uint64_t unit, const std::string& problem) {
  throw UserError("records.bin: byte " + std::to_string(unit * kUnitBytes) + ": " + problem +
                  "; the capture is damaged, capture again");
}

}  // namespace

std::uint32_t units_of(RecordKind kind) {
  switch (kind) {
    case RecordKind::kRay:
      return kRayUnits;
    case RecordKind::kHit:
      return kHitUnits;
    case RecordKind::kMiss:
      return kMissUnits;
    case RecordKind::kAnyHit:
      return kAnyHitUnits;
    case RecordKind::kReport:
      return kReportUnits;
    case RecordKind::kEnd:
      return kEndUnits;
    case RecordKind::kSegment:
      return kSegmentUnits;
    case RecordKind::kQueryStep:
      return kQueryStepUnits;
    case RecordKind::kQueryVerdict:
      return kQueryVerdictUnits;
  }
  return 0;
}

DispatchRecords::DispatchRecords(std::span<const std::byte> records, std::uint64_t first,
                                 std::uint64_t last, const RawDispatch& dispatch)
    : base_(records.data() + first * kUnitBytes) {
  if (last - first > 0xffffffffu) {
    throw UserError("dispatch " + std::to_string(dispatch.block.dispatch) +
                    " left more than 64 GiB of records; capture fewer pixels");
  }
  const std::uint64_t launches =
      std::uint64_t{dispatch.block.width} * dispatch.block.height * dispatch.block.depth;
  for (std::uint64_t unit = first; unit < last;) {
    const Record record(records.data() + unit * kUnitBytes);
    const std::uint32_t units = units_of(record.kind());
    if (units == 0) {
      damaged(unit, "record of unknown kind " +
                        std::to_string(static_cast<std::uint32_t>(record.kind())));
    }
    if (units > last - unit) {
      damaged(unit, "record cut off by the end of its dispatch");
    }
    if (record.dispatch() != dispatch.block.dispatch) {
      damaged(unit, "record of dispatch " + std::to_string(record.dispatch()) +
                        " among those of dispatch " + std::to_string(dispatch.block.dispatch));
    }
    if (record.launch() >= launches) {
      damaged(unit, "launch id " + std::to_string(record.launch()) + " of only " +
                        std::to_string(launches));
    }
    ++counts_[static_cast<std::size_t>(record.kind())];
    order_.push_back(std::uint64_t{record.launch()} << 32 | (unit - first));
    unit += units;
  }
  std::sort(order_.begin(), order_.end());
}

}  // namespace a2rt::import
