// Runs a unit over a whole workload, without time: hits, counts of events, traffic, audit.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "a2rt/rt/event.h"
#include "a2rt/rt/unit.h"
#include "a2rt/workload/workload.h"

namespace a2rt::rt {

struct FunctionalOptions {
  unsigned threads = 1;
  bool events = true;  // count events and traffic
  // Rays to audit against exact arithmetic, evenly spread over the workload; 0: none.
  std::uint64_t audit_rays = 0;
  std::function<void(double)> progress;  // share of the rays done; called from one thread at a time
};

struct TrafficTotal {
  std::uint64_t accesses = 0, bytes = 0;
  friend bool operator==(const TrafficTotal&, const TrafficTotal&) = default;
};

struct EventTotals {
  // Sums of Event::count; for kAnyHit, whose count is an ordinal, the number of events.
  std::array<std::uint64_t, static_cast<std::size_t>(EventKind::kCount)> events{};
  std::array<TrafficTotal, static_cast<std::size_t>(Traffic::kCount)> traffic{};
  void add(const Event& event);
  void add(const EventTotals& other);
  friend bool operator==(const EventTotals&, const EventTotals&) = default;
};

struct FunctionalResult {
  std::vector<Hit> hits;  // one per ray
  EventTotals totals;
  Audit audit;
  std::uint64_t audited_rays = 0;
  double seconds = 0;  // tracing only
};

// Adds up two audits.
void add_audit(Audit& sum, const Audit& other);

// The unit must have been built on `workload`. All but `seconds` is the same for any number of
// threads.
FunctionalResult run_functional(const RtUnit& unit, const Workload& workload,
                                const FunctionalOptions& options = {});

}  // namespace a2rt::rt
