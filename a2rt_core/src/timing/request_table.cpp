#include "a2rt/timing/request_table.h"

#include <algorithm>
#include <bit>

#include "a2rt/base/error.h"

namespace a2rt::timing {

RequestTable::RequestTable() {
  entries_.reserve(64);
  buckets_.fill(kNil);
}

void RequestTable::clear() {
  A2RT_CHECK(live_ == 0, "requests of a warp that has ended are under way");
  entries_.clear();
  buckets_.fill(kNil);
  free_ = first_ = last_ = kNil;
}

// Finds the line's entry or makes one. Entries whose data has come are dropped on the way.
std::uint16_t RequestTable::obtain(Cycles now, std::uint64_t line, Traffic kind) {
  std::uint16_t* link = &buckets_[bucket(line)];
  while (*link != kNil) {
    const std::uint16_t index = *link;
    Entry& entry = entries_[index];
    if (entry.line == line) {
      return index;
    }
    if (!entry.busy() && entry.known <= now) {
      *link = entry.hash_next;
      entry.hash_next = free_;
      free_ = index;
    } else {
      link = &entry.hash_next;
    }
  }
  std::uint16_t index = free_;
  if (index == kNil) {
    A2RT_CHECK(entries_.size() < kNil / 4, "a warp asks for more lines than a token can name");
    index = static_cast<std::uint16_t>(entries_.size());
    entries_.emplace_back();
    link = &buckets_[bucket(line)];
    while (*link != kNil) {
      link = &entries_[*link].hash_next;
    }
  } else {
    free_ = entries_[index].hash_next;
  }
  Entry& entry = entries_[index];
  entry.line = line;
  entry.lanes = {};
  entry.kind = kind;
  entry.arriving = 0;
  entry.hash_next = kNil;
  *link = index;
  return index;
}

void RequestTable::queue(std::uint16_t index) {
  entries_[index].queue_next = kNil;
  (first_ == kNil ? first_ : entries_[last_].queue_next) = index;
  last_ = index;
}

RequestTable::Added RequestTable::add(Cycles now, std::uint32_t lane, std::uint64_t line,
                                      SectorMask wanted, Traffic kind) {
  const std::uint16_t index = obtain(now, line, kind);
  Entry& entry = entries_[index];
  const std::uint32_t bit = 1u << lane;
  Added added;
  SectorMask waits = wanted;
  if (entry.arriving != 0) {
    if (entry.known <= now) {
      entry.arriving = 0;
    } else if (const auto coming = static_cast<SectorMask>(wanted & entry.arriving); coming != 0) {
      added.ready = entry.known;
      added.sectors = sectors_in(coming);
      waits = static_cast<SectorMask>(wanted & ~coming);
      if (waits == 0) {
        return added;
      }
    }
  }
  if (!entry.busy()) {
    for (std::uint32_t s = 0; s < kSectorsPerLine; ++s) {
      entry.lanes[s] = (waits >> s & 1) * bit;
    }
    added.sectors += sectors_in(waits);
    added.lines = 1;
    entry.to_send = waits;
    queue(index);
    ++live_;
    return added;
  }
  SectorMask already = 0;
  for (std::uint32_t s = 0; s < kSectorsPerLine; ++s) {
    already = static_cast<SectorMask>(already | (entry.lanes[s] >> lane & 1) << s);
    entry.lanes[s] |= (waits >> s & 1) * bit;
  }
  added.sectors += sectors_in(static_cast<SectorMask>(waits & ~already));
  added.lines = already == 0;
  const bool was_queued = entry.to_send != 0;
  entry.to_send = static_cast<SectorMask>(entry.to_send | (waits & ~entry.in_flight));
  if (!was_queued && entry.to_send != 0) {
    queue(index);
  }
  return added;
}

RequestTable::Next RequestTable::next() const {
  const Entry& entry = entries_[first_];
  return {Address{entry.line * kLineBytes}, entry.to_send, entry.kind, first_};
}

void RequestTable::sent(SectorMask accepted) {
  Entry& entry = entries_[first_];
  entry.to_send = static_cast<SectorMask>(entry.to_send & ~accepted);
  entry.in_flight = static_cast<SectorMask>(entry.in_flight | accepted);
  if (entry.to_send == 0) {
    first_ = entry.queue_next;
  }
}

std::uint32_t RequestTable::take(std::uint32_t token, SectorMask sectors, const SectorTimes& ready,
                                 std::array<std::uint32_t, kSectorsPerLine>& lanes) {
  Entry& entry = entries_[token];
  A2RT_CHECK((entry.in_flight & sectors) == sectors,
             "data came for a sector that was not under way");
  if (entry.arriving == 0) {
    entry.known = Cycles{0};
  }
  for_each_sector(sectors, [&](std::uint32_t s) {
    lanes[s] = entry.lanes[s];
    entry.lanes[s] = 0;
    entry.known = std::max(entry.known, ready[s]);
  });
  entry.in_flight = static_cast<SectorMask>(entry.in_flight & ~sectors);
  entry.arriving = static_cast<SectorMask>(entry.arriving | sectors);
  live_ -= !entry.busy();
  return entry.lanes[0] | entry.lanes[1] | entry.lanes[2] | entry.lanes[3];
}

}  // namespace a2rt::timing
