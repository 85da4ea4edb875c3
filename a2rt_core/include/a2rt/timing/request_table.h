// The outstanding fetches of one warp in the RT unit's buffer, merged by sector.
//
// Lanes that want the same sector share one request, whether it still waits for the L1 port, waits
// for its data, or has been found in L1 and is on its way out of the cache's pipe. Lines are sent
// in the order in which they were first asked for. A lane waits for lines; it is told about each
// once, when the last of its sectors there has a time.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "a2rt/base/units.h"
#include "a2rt/rt/event.h"
#include "a2rt/timing/memory_port.h"

namespace a2rt::timing {

class RequestTable {
 public:
  RequestTable();
  // Forgets the data on its way; nothing may wait to be sent or be under way.
  void clear();

  struct Added {
    std::uint32_t sectors = 0;  // asked for; those the lane already waits for do not count
    std::uint32_t lines = 0;    // that the lane has to wait for and did not before
    Cycles ready;               // when the sectors of known arrival are all there
  };
  // Lane `lane` wants these sectors of a line at `now`.
  Added add(Cycles now, std::uint32_t lane, std::uint64_t line, SectorMask wanted, Traffic kind);

  bool nothing_to_send() const { return first_ == kNil; }
  struct Next {
    Address line;
    SectorMask sectors;
    Traffic kind;
    std::uint32_t token;  // to be given back to arrived()
  };
  Next next() const;
  // Of the request shown by next(), `accepted` were taken by L1.
  void sent(SectorMask accepted);

  // The times of some sectors of a sent request became known. Calls f(lane, ready, complete) for
  // each lane that wanted any: the cycle of its last one, and whether the lane waits for no more of
  // the line. `f` may add requests.
  template <class F>
  void arrived(std::uint32_t token, SectorMask sectors, const SectorTimes& ready, const F& f) {
    std::array<std::uint32_t, kSectorsPerLine> lanes{};
    const std::uint32_t waiting = take(token, sectors, ready, lanes);
    // Sectors come in ascending order, so a lane's last one is the highest it wanted.
    std::uint32_t told = 0;
    for (std::uint32_t s = kSectorsPerLine; s-- > 0;) {
      const std::uint32_t tell = lanes[s] & ~told;
      told |= lanes[s];
      for (std::uint32_t rest = tell; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(rest));
        f(lane, ready[s], (waiting >> lane & 1) == 0);
      }
    }
  }

  // Lines with sectors to send or under way.
  std::uint32_t live() const { return live_; }

 private:
  static constexpr std::uint16_t kNil = 0xffff;
  static constexpr std::size_t kBuckets = 128;
  struct alignas(64) Entry {
    std::uint64_t line = 0;
    Cycles known;                                        // when all sectors of `arriving` are there
    std::array<std::uint32_t, kSectorsPerLine> lanes{};  // waiting, bit per lane
    std::uint16_t hash_next = kNil, queue_next = kNil;
    SectorMask to_send = 0, in_flight = 0, arriving = 0;
    Traffic kind = Traffic::kNone;
    bool busy() const { return (to_send | in_flight) != 0; }
  };
  std::size_t bucket(std::uint64_t line) const { return (line * 0x9e3779b97f4a7c15u) >> 57; }
  // Settles the entry; returns the lanes that still wait for others of its sectors.
  std::uint32_t take(std::uint32_t token, SectorMask sectors, const SectorTimes& ready,
                     std::array<std::uint32_t, kSectorsPerLine>& lanes);
  std::uint16_t obtain(Cycles now, std::uint64_t line, Traffic kind);
  void queue(std::uint16_t index);

  std::vector<Entry> entries_;
  std::array<std::uint16_t, kBuckets> buckets_;
  std::uint16_t free_ = kNil, first_ = kNil, last_ = kNil;
  std::uint32_t live_ = 0;
};

}  // namespace a2rt::timing
