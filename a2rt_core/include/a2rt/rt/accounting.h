// How AQB8's public branches of Vulkan-Sim charge memory (github nycu-caslab/AQB8; source: its
// vulkan_ray_tracing.cc on baseline-6wide and AQB8-6wide), slips included, so that a reader can see
// how much of a published gain is one. `published`:
//   - a record is charged in whole 64-byte lines: the one it starts in, and the next unless more
//     bytes than the record's are left in the first (so also when it ends exactly on the line);
//   - the baseline's 168-byte node (six FP32 boxes and six words) goes through another loop, which
//     stops one line early: 2.5 of 3.5 lines on average;
//   - the baseline's triangles lie in mesh order behind a 4-byte index each, AQB8's in leaf order;
//   - every line of an index read also writes a 32-byte hit record: the baseline once per triangle
//     tested, AQB8 once per ray that hit.
// `corrected`: the same nodes and visits, all lines counted, all triangles in leaf order, one index
// and one hit record per ray that hit.
#pragma once

#include <cstdint>

#include "a2rt/base/units.h"
#include "a2rt/rt/event.h"
#include "a2rt/rt/settings.h"

namespace a2rt::rt {

inline constexpr std::uint64_t kPublishedLine = 64;
inline constexpr std::uint32_t kPublishedIndexBytes = 4, kPublishedResultBytes = 32;
inline constexpr std::uint32_t kPublishedBaselineNodeBytes = 168;

// Lines of a record, first to last; `visit` gets each line's address.
template <class Visit>
void published_lines(Accounting accounting, Address record, std::uint64_t bytes,
                     const Visit& visit) {
  const std::uint64_t first = record.value / kPublishedLine;
  std::uint64_t last = (record.value + bytes - 1) / kPublishedLine;
  if (accounting == Accounting::kPublished) {
    const std::uint64_t left = kPublishedLine - record.value % kPublishedLine;
    last = left > bytes ? first : first + 1;
  }
  for (std::uint64_t line = first; line <= last; ++line) {
    visit(Address{line * kPublishedLine});
  }
}

template <class Sink>
void fetch_lines(Sink& sink, Accounting accounting, Traffic traffic, Address record,
                 std::uint64_t bytes) {
  published_lines(accounting, record, bytes,
                  [&](Address line) { sink.fetch(traffic, line, kPublishedLine); });
}

// The baseline's 168-byte node.
template <class Sink>
void fetch_wide_node(Sink& sink, Accounting accounting, Address node) {
  const std::uint64_t first = node.value / kPublishedLine;
  const std::uint64_t end = (node.value + kPublishedBaselineNodeBytes - 1) / kPublishedLine +
                            (accounting == Accounting::kPublished ? 0 : 1);
  for (std::uint64_t line = first; line < end; ++line) {
    sink.fetch(Traffic::kNode, Address{line * kPublishedLine}, kPublishedLine);
  }
}

// A primitive index, and the hit record that the public code writes with each of its lines.
template <class Sink>
void fetch_index(Sink& sink, Accounting accounting, Address index, Address result) {
  published_lines(accounting, index, kPublishedIndexBytes, [&](Address line) {
    sink.fetch(Traffic::kPrimitiveIndex, line, kPublishedLine);
    sink.fetch(Traffic::kResult, result, kPublishedResultBytes);
  });
}

}  // namespace a2rt::rt
