// The outstanding fetches of one warp in the RT unit's buffer, merged by sector.
//
// Lanes that want the same sector share one request, whether it still waits for the L1 port, waits
// for its data, or has been found in L1 and is on its way out of the cache's pipe. Lines are sent
// in the order in which they were first asked for, as what the first lane wants there. A lane waits
// for lines; it is told about each once, when the last of its sectors there has a time.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/base/inline.h"
#include "a2rt/base/units.h"
#include "a2rt/rt/event.h"
#include "a2rt/timing/memory_port.h"

namespace a2rt::timing {

class RequestTable {
 public:
  RequestTable();
  // Forgets the data on its way; nothing may wait to be sent or be under way.
  void clear();

  // Lane `lane` wants these sectors of a line at `now`, of which it has not asked for any since it
  // last waited. Returns true if it has to wait for the line; of the sectors of known arrival the
  // last moves `ready`.
  A2RT_INLINE bool add(Cycles now, std::uint32_t lane, std::uint64_t line, SectorMask wanted,
                       Traffic kind, Cycles& ready) {
    const std::uint16_t index = obtain(now, line);
    Entry& entry = entries_[index];
    if (entry.known <= now) {
      entry.arriving = 0;
    }
    const auto waits = static_cast<SectorMask>(wanted & ~entry.arriving);
    if (waits != wanted) [[unlikely]] {
      ready = std::max(ready, entry.known);
      if (waits == 0) {
        return false;
      }
    }
    entry.lanes |= kSpread[waits] & 1u << lane;
    const auto fresh = static_cast<SectorMask>(waits & ~(entry.in_flight | entry.to_send));
    if (fresh != 0) {
      live_ += !entry.busy();
      entry.kind = entry.busy() ? entry.kind : kind;
      if (entry.to_send == 0) {
        entry.queue_next = kNone;
        entries_[last_].queue_next = index;
        last_ = index;
      }
      entry.to_send = static_cast<SectorMask>(entry.to_send | fresh);
    }
    return true;
  }

  bool nothing_to_send() const { return last_ == kNone; }
  struct Next {
    Address line;
    SectorMask sectors;
    Traffic kind;
    std::uint32_t token;  // to be given back to arrived()
  };
  Next next() const {
    const std::uint16_t first = entries_[kNone].queue_next;
    const Entry& entry = entries_[first];
    return {Address{entry.line * kLineBytes}, entry.to_send, entry.kind, first};
  }
  // Of the request shown by next(), `accepted` were taken by L1.
  void sent(SectorMask accepted) {
    const std::uint16_t first = entries_[kNone].queue_next;
    Entry& entry = entries_[first];
    entry.to_send = static_cast<SectorMask>(entry.to_send & ~accepted);
    entry.in_flight = static_cast<SectorMask>(entry.in_flight | accepted);
    if (entry.to_send == 0) {
      entries_[kNone].queue_next = entry.queue_next;
      last_ = last_ == first ? kNone : last_;
    }
  }

  // The times of some sectors of a sent request became known. Calls f(lane, ready, complete) for
  // each lane that wanted any: the cycle of its last one, and whether the lane waits for no more of
  // the line. `f` may add requests.
  template <class F>
  A2RT_INLINE void arrived(std::uint32_t token, SectorMask sectors, const SectorTimes& ready,
                           const F& f) {
    Entry& entry = entries_[token];
    A2RT_CHECK((entry.in_flight & sectors) == sectors,
               "data came for a sector that was not under way");
    const LaneMasks lanes = entry.lanes & kSpread[sectors];
    entry.lanes ^= lanes;
    entry.in_flight = static_cast<SectorMask>(entry.in_flight & ~sectors);
    const std::uint32_t waiting = entry.busy() ? any_of(entry.lanes) : 0;
    // Sectors come in ascending order.
    auto end = static_cast<std::uint32_t>(std::bit_width(unsigned{sectors}));
    entry.known = std::max(ready[end - 1], entry.arriving == 0 ? Cycles{0} : entry.known);
    entry.arriving = static_cast<SectorMask>(entry.arriving | sectors);
    live_ -= !entry.busy();
    const auto tell = [&](std::uint32_t told, Cycles at) {
      for_each_bit(told, [&](std::uint32_t lane) { f(lane, at, (waiting >> lane & 1) == 0); });
    };
    // A lane's last sector is the highest it wanted.
    for (std::uint32_t left = any_of(lanes); left != 0;) {
      const std::uint32_t told = lanes[--end] & left;
      left ^= told;
      tell(told, ready[end]);
    }
  }

  // The line will be asked for soon: brings what that touches into the host's caches.
  void prefetch(std::uint64_t line) const { __builtin_prefetch(&entries_[buckets_[bucket(line)]]); }

  // Lines with sectors to send or under way.
  std::uint32_t live() const { return live_; }

 private:
  // The first entry is no request. It ends every chain, and comes before the first to be sent.
  static constexpr std::uint16_t kNone = 0;
  static constexpr std::uint64_t kNoLine = ~std::uint64_t{0};
  // For each sector of a line, a bit per lane. A vector, as all four change at once.
  using LaneMasks [[gnu::vector_size(16)]] = std::uint32_t;
  static std::uint32_t any_of(LaneMasks lanes) { return lanes[0] | lanes[1] | lanes[2] | lanes[3]; }
  // For each mask of sectors: all bits of those in it.
  static constexpr auto kSpread = [] {
    std::array<LaneMasks, 1u << kSectorsPerLine> table{};
    for (std::uint32_t m = 0; m < table.size(); ++m) {
      table[m] =
          LaneMasks{0u - (m & 1u), 0u - (m >> 1 & 1u), 0u - (m >> 2 & 1u), 0u - (m >> 3 & 1u)};
    }
    return table;
  }();
  static constexpr std::size_t kBuckets = 128;
  static constexpr std::size_t kMostEntries = 0x4000;
  struct alignas(64) Entry {
    LaneMasks lanes{};  // waiting
    std::uint64_t line = kNoLine;
    Cycles known;  // when all sectors of `arriving` are there
    std::uint16_t hash_next = kNone, queue_next = kNone;
    SectorMask to_send = 0, in_flight = 0, arriving = 0;
    Traffic kind = Traffic::kNone;
    bool busy() const { return (to_send | in_flight) != 0; }
  };
  static_assert(kSectorsPerLine == 4);
  std::size_t bucket(std::uint64_t line) const { return mixed(line) >> 57; }
  // Finds the line's entry or makes one.
  std::uint16_t obtain(Cycles now, std::uint64_t line) {
    const std::uint16_t first = buckets_[bucket(line)];
    if (entries_[first].line == line) {
      return first;
    }
    return obtain_further(now, line);
  }
  A2RT_NOINLINE std::uint16_t obtain_further(Cycles now, std::uint64_t line);
  std::vector<Entry> entries_;
  std::uint16_t free_ = kNone, last_ = kNone;
  std::uint32_t live_ = 0;
  std::array<std::uint16_t, kBuckets> buckets_;
};

}  // namespace a2rt::timing
