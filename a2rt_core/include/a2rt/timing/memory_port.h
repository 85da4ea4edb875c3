// The seam between the levels of the memory system, where tests put their mocks.
//
// Levels talk in lines: one message names the sectors wanted of one 128-byte line. Each sector
// still takes its own cycle of every port, bank and lookup it goes through; only the messages are
// fewer.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "a2rt/base/bits.h"
#include "a2rt/base/error.h"
#include "a2rt/base/inline.h"
#include "a2rt/base/units.h"
#include "a2rt/rt/event.h"
#include "a2rt/timing/tag_store.h"

namespace a2rt::timing {

inline constexpr std::size_t kTrafficKinds = static_cast<std::size_t>(Traffic::kCount);
using TrafficCounts = std::array<std::uint64_t, kTrafficKinds>;

// A core cycle per sector of a line; only those of the sectors in question mean anything.
using SectorTimes = std::array<Cycles, kSectorsPerLine>;

// Calls f(line, sectors) for each line that [address, address + bytes) touches, ascending.
template <class F>
A2RT_INLINE void for_each_line(Address address, std::uint64_t bytes, const F& f) {
  constexpr std::uint32_t kAll = (1u << kSectorsPerLine) - 1;
  const std::uint64_t first = address.value / kSectorBytes;
  const std::uint64_t end = (address.value + bytes - 1) / kSectorBytes;
  const std::uint64_t last_line = end / kSectorsPerLine;
  std::uint32_t sectors = kAll << first % kSectorsPerLine & kAll;
  for (std::uint64_t line = first / kSectorsPerLine; line < last_line; ++line) {
    f(line, static_cast<SectorMask>(sectors));
    sectors = kAll;
  }
  f(last_line, static_cast<SectorMask>(sectors & ((2u << end % kSectorsPerLine) - 1)));
}

// Receives the sectors a level asked for.
class LineSink {
 public:
  virtual ~LineSink() = default;
  // The i-th sector of the mask (ascending) is there in cycle `now` + i.
  virtual void fill(Cycles now, Address line, SectorMask sectors) = 0;
};

// What is below a cache.
class LowerLevel {
 public:
  virtual ~LowerLevel() = default;
  // Reads: every sector is answered once by LineSink::fill of requester `sm`, together or apart.
  // Writes are answered by nothing. `leaves` is the core cycle at which the first sector's request
  // leaves the cache above, never in the past; the others follow a cycle apart.
  virtual void request(Cycles leaves, std::uint32_t sm, Address line, SectorMask sectors,
                       Traffic kind, bool write) = 0;
  // Model "reserved": reads are answered by read() at once, and request() is for writes only.
  virtual bool answers_at_once() const { return false; }
  // Returns the cycle in which the first sector is there; the others follow a cycle apart.
  virtual Cycles read(Cycles /*leaves*/, std::uint32_t /*sm*/, Address /*line*/,
                      SectorMask /*sectors*/, Traffic /*kind*/) {
    A2RT_CHECK(false, "this level of memory answers reads later");
  }
};

// Accesses of one cache by kind of data, in sectors of 32 B.
struct CacheCounts {
  TrafficCounts reads{}, hits{}, merges{}, misses{}, writes{};
  std::uint64_t bank_conflicts = 0;  // cycles lost
  std::uint64_t mshr_full = 0;       // attempts turned away
  std::uint64_t fills = 0;
  std::uint64_t evictions = 0;
  std::uint64_t written_back = 0;
};

}  // namespace a2rt::timing
