#include <algorithm>
#include <bit>

#include "driver.h"

namespace a2rt::spirv::testing {
namespace {

using capture::RecordKind;

constexpr std::uint32_t kUnitWords = capture::kUnitBytes / 4;
constexpr std::uint32_t kGuardWords = 64;

std::uint32_t units_of(RecordKind kind) {
  switch (kind) {
    case RecordKind::kRay:
      return capture::kRayUnits;
    case RecordKind::kMiss:
      return capture::kMissUnits;
    case RecordKind::kHit:
    case RecordKind::kAnyHit:
    case RecordKind::kReport:
    case RecordKind::kEnd:
    case RecordKind::kSegment:
    case RecordKind::kQueryStep:
    case RecordKind::kQueryVerdict:
      return 3;
  }
  return 0;
}

}  // namespace

Recording::Recording(Driver& driver, std::uint32_t most_units, std::uint32_t launches)
    : most_units_(most_units),
      launches_(launches),
      header_(driver, sizeof(capture::RecordHeader)),
      records_(driver, (most_units + capture::kSpareUnits) * capture::kUnitBytes + kGuardWords * 4),
      ordinals_(driver, (launches + 1) * 4),
      index_(driver, launches * 8),
      verdicts_(driver, launches * sizeof(capture::VerdictEntry)) {
  reset(most_units);
}

void Recording::reset(std::uint32_t capacity) {
  capacity_ = capacity;
  capture::RecordHeader& h = header();
  h = {};
  h.capacity = capacity;
  h.dispatch = 77;
  h.records = records_.address();
  h.ordinals = ordinals_.address();
  h.ordinal_launches = launches_;
  std::uint32_t* const words = records_.data<std::uint32_t>();
  std::fill_n(words, (most_units_ + capture::kSpareUnits) * kUnitWords + kGuardWords, 0u);
  std::fill_n(words + (capacity + capture::kSpareUnits) * kUnitWords, kGuardWords, kGuard);
  // A stale ordinal must be reset by the shader.
  std::fill_n(ordinals_.data<std::uint32_t>(), launches_, 1234u);
  std::fill_n(index_.data<std::uint32_t>(), 2 * launches_, 0u);
}

void Recording::set_verdict(std::uint32_t launch, capture::VerdictEntry entry) {
  header().verdict_index = index_.address();
  header().verdicts = verdicts_.address();
  header().verdict_launches = launches_;
  index_.data<std::uint32_t>()[2 * launch] = launch;
  index_.data<std::uint32_t>()[2 * launch + 1] = 1;
  verdicts_.data<capture::VerdictEntry>()[launch] = entry;
}

bool Recording::guard_intact() const {
  const std::uint32_t* const guard =
      records_.data<std::uint32_t>() + (capacity_ + capture::kSpareUnits) * kUnitWords;
  return std::all_of(guard, guard + kGuardWords, [](std::uint32_t w) { return w == kGuard; });
}

float Recording::Record::real(std::size_t word) const { return std::bit_cast<float>(words[word]); }

std::uint32_t Recording::Record::counter(capture::Counter c) const {
  const std::size_t first = kind == RecordKind::kRay ? 4 * kUnitWords : kUnitWords;
  return words[first + static_cast<std::size_t>(c)];
}

std::vector<Recording::Record> Recording::all() const {
  std::vector<Record> found;
  const std::uint32_t* const base = records_.data<std::uint32_t>();
  const std::uint32_t end = std::min(header_.data<capture::RecordHeader>()->cursor, capacity_);
  for (std::uint32_t unit = 0; unit < end;) {
    const std::uint32_t* const words = base + unit * kUnitWords;
    const auto kind = static_cast<RecordKind>(words[0] & 0xff);
    const std::uint32_t units = units_of(kind);
    if (units == 0 || unit + units > capacity_) {
      break;  // what did not fit leaves the rest of the buffer empty
    }
    found.push_back({kind, static_cast<capture::Stage>(words[0] >> 8 & 0xff), words[0] >> 16,
                     words[1], words[2], words[3], words});
    unit += units;
  }
  return found;
}

std::vector<Recording::Record> Recording::of(std::uint32_t launch) const {
  std::vector<Record> found = all();
  std::erase_if(found, [&](const Record& r) { return r.launch != launch; });
  return found;
}

std::size_t Recording::count() const { return all().size(); }

}  // namespace a2rt::spirv::testing
