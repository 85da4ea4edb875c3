#include "a2rt/timing/request_table.h"

#include <bit>

#include "a2rt/base/error.h"

namespace a2rt::timing {

RequestTable::RequestTable() {
  entries_.reserve(64);
  buckets_.fill(kNil);
}

std::uint16_t RequestTable::obtain(std::uint64_t line, Traffic kind) {
  std::uint16_t& head = buckets_[bucket(line)];
  for (std::uint16_t i = head; i != kNil; i = entries_[i].hash_next) {
    if (entries_[i].line == line) {
      return i;
    }
  }
  std::uint16_t index = free_;
  if (index == kNil) {
    A2RT_CHECK(entries_.size() < kNil / 4, "a warp asks for more lines than a token can name");
    index = static_cast<std::uint16_t>(entries_.size());
    entries_.emplace_back();
  } else {
    free_ = entries_[index].hash_next;
  }
  Entry& entry = entries_[index];
  entry.line = line;
  entry.lanes = {};
  entry.kind = kind;
  entry.hash_next = head;
  head = index;
  ++live_;
  return index;
}

std::uint32_t RequestTable::add(std::uint32_t lane, Address address, std::uint32_t bytes,
                                Traffic kind) {
  const std::uint64_t first = address.value / kSectorBytes;
  const std::uint64_t last = (address.value + bytes - 1) / kSectorBytes;
  std::uint32_t added = 0;
  for (std::uint64_t line = first / kSectorsPerLine; line <= last / kSectorsPerLine; ++line) {
    const std::uint64_t base = line * kSectorsPerLine;
    const std::uint64_t from = first > base ? first - base : 0;
    const std::uint64_t to = last < base + kSectorsPerLine - 1 ? last - base : kSectorsPerLine - 1;
    const std::uint16_t index = obtain(line, kind);
    Entry& entry = entries_[index];
    const bool queued = entry.to_send != 0;
    for (std::uint64_t s = from; s <= to; ++s) {
      // Two records of one read may share a sector; the lane waits for it once.
      added += (entry.lanes[s] >> lane & 1) == 0;
      entry.lanes[s] |= 1u << lane;
      if ((entry.in_flight >> s & 1) == 0) {
        entry.to_send = static_cast<std::uint8_t>(entry.to_send | 1u << s);
      }
    }
    if (!queued && entry.to_send != 0) {
      entry.queue_next = kNil;
      (first_ == kNil ? first_ : entries_[last_].queue_next) = index;
      last_ = index;
    }
  }
  return added;
}

RequestTable::Next RequestTable::next() const {
  const Entry& entry = entries_[first_];
  const auto s = static_cast<std::uint32_t>(std::countr_zero(entry.to_send));
  return {Address{entry.line * kLineBytes + s * kSectorBytes}, entry.kind,
          static_cast<std::uint32_t>(first_) * kSectorsPerLine + s};
}

void RequestTable::sent() {
  Entry& entry = entries_[first_];
  const auto bit = static_cast<std::uint8_t>(entry.to_send & -entry.to_send);
  entry.to_send = static_cast<std::uint8_t>(entry.to_send & ~bit);
  entry.in_flight = static_cast<std::uint8_t>(entry.in_flight | bit);
  if (entry.to_send == 0) {
    first_ = entry.queue_next;
  }
}

std::uint32_t RequestTable::arrived(std::uint32_t token) {
  const auto index = static_cast<std::uint16_t>(token / kSectorsPerLine);
  const std::uint32_t s = token % kSectorsPerLine;
  Entry& entry = entries_[index];
  A2RT_CHECK(entry.in_flight >> s & 1, "data came for a sector that was not under way");
  entry.in_flight = static_cast<std::uint8_t>(entry.in_flight & ~(1u << s));
  const std::uint32_t lanes = entry.lanes[s];
  entry.lanes[s] = 0;
  if (entry.in_flight == 0 && entry.to_send == 0) {
    std::uint16_t* link = &buckets_[bucket(entry.line)];
    while (*link != index) {
      link = &entries_[*link].hash_next;
    }
    *link = entry.hash_next;
    entry.hash_next = free_;
    free_ = index;
    --live_;
  }
  return lanes;
}

}  // namespace a2rt::timing
