#include "a2rt/timing/request_table.h"

#include <algorithm>
#include <bit>

#include "a2rt/base/error.h"

namespace a2rt::timing {

RequestTable::RequestTable() {
  entries_.reserve(64);
  clear();
}

void RequestTable::clear() {
  A2RT_CHECK(live_ == 0, "requests of a warp that has ended are under way");
  entries_.assign(1, {});
  buckets_.fill(kNone);
  free_ = kNone;
  last_ = kNone;
}

// Entries whose data has come are dropped on the way; a new one goes where the next of its lane's
// neighbours will look first.
std::uint16_t RequestTable::obtain_further(Cycles now, std::uint64_t line) {
  std::uint16_t& head = buckets_[bucket(line)];
  std::uint16_t* link = &head;
  while (*link != kNone) {
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
  if (index == kNone) {
    A2RT_CHECK(entries_.size() < kMostEntries, "a warp asks for more lines than a token can name");
    index = static_cast<std::uint16_t>(entries_.size());
    entries_.emplace_back();
  } else {
    free_ = entries_[index].hash_next;
  }
  Entry& entry = entries_[index];
  entry.line = line;
  entry.arriving = 0;
  entry.hash_next = head;
  head = index;
  return index;
}

}  // namespace a2rt::timing
