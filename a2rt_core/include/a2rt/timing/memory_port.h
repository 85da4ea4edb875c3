// The seam between the levels of the memory system, where tests put their mocks.
#pragma once

#include <array>
#include <cstdint>

#include "a2rt/base/units.h"
#include "a2rt/rt/event.h"

namespace a2rt::timing {

inline constexpr std::size_t kTrafficKinds = static_cast<std::size_t>(Traffic::kCount);
using TrafficCounts = std::array<std::uint64_t, kTrafficKinds>;

// Receives the sectors a level asked for.
class SectorSink {
 public:
  virtual ~SectorSink() = default;
  virtual void fill(Cycles now, Address sector) = 0;
};

// What is below a cache.
class LowerLevel {
 public:
  virtual ~LowerLevel() = default;
  // A read is answered by exactly one SectorSink::fill of requester `sm`; a write by nothing.
  // `leaves` is the core cycle at which the request leaves the cache above, never in the past.
  virtual void request(Cycles leaves, std::uint32_t sm, Address sector, Traffic kind,
                       bool write) = 0;
};

// Accesses of one cache by kind of data, in sectors of 32 B.
struct CacheCounts {
  TrafficCounts reads{}, hits{}, merges{}, misses{}, writes{};
  std::uint64_t bank_conflicts = 0;  // attempts turned away
  std::uint64_t mshr_full = 0;       // likewise
  std::uint64_t fills = 0;
  std::uint64_t evictions = 0;
  std::uint64_t written_back = 0;
};

}  // namespace a2rt::timing
