// Tags of sets of many ways with true LRU, in one hash table over all of them, so that a fully
// associative cache is as cheap to look up as any.
//
// A bucket of the table is one line of the host and has room for four lines of the cache; half of
// it stays free, so that a line is mostly in the bucket where it belongs and a lookup reads nothing
// else. The order of use is a log: a use appends the line to it and strikes out its last entry, so
// the oldest entry that is not struck out is the least recent line. That writes to one end of the
// log, where a list through the lines would write to the lines used before and after.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

#include "a2rt/base/inline.h"
#include "a2rt/base/vector_support.h"
#include "a2rt/timing/sectors.h"
#include "a2rt/timing/wrap.h"

namespace a2rt::timing {

class HashedSets {
 public:
  // There are 17 lines or more.
  HashedSets(std::uint64_t sets, std::uint32_t ways);

  // As in TagStore; `line` is a line number.
  std::uint32_t places() const { return (bucket_mask_ + 1) * kRoom; }
  std::uint32_t guess(std::uint64_t line) const { return home(line) * kRoom; }
  Held look(std::uint64_t line) const {
    for (std::uint32_t b = home(line);; b = next(b)) {
      const Bucket& bucket = buckets_[b];
      if (const std::uint32_t found = bucket.matches(line); found != 0) [[likely]] {
        const auto i = static_cast<std::uint32_t>(std::countr_zero(found));
        return {b * kRoom + i, bucket.sectors[i].valid};
      }
      if (bucket.passed_on == 0) [[likely]] {
        return {places(), 0};
      }
    }
  }
  void use(std::uint64_t line, std::uint32_t number) {
    const Place place = place_of(number);
    strike_out(place);
    append(sets_[wrap_.of(line)], place);
  }
  void prefetch(std::uint64_t line) const { __builtin_prefetch(&buckets_[home(line)]); }
  Entered enter(Cycles now, std::uint32_t number, std::uint64_t line, SectorMask sectors,
                Traffic kind, bool dirty, SectorResidence& residence) {
    return put(now, place_of(number), line, sectors, kind, dirty, residence);
  }

 private:
  static constexpr std::uint32_t kRoom = 4;       // lines a bucket holds
  static constexpr std::uint32_t kLogPerWay = 4;  // entries; more are compacted less often
  static constexpr std::uint64_t kUnused = ~std::uint64_t{0};  // no line's number
  using Words [[gnu::vector_size(16)]] = std::uint32_t;
  struct Sectors {
    SectorMask valid : 4 = 0, dirty : 4 = 0;
  };
  // A line that finds its bucket full goes to the next one that is not; nothing moves later.
  struct alignas(64) Bucket {
    Words low = ~Words{}, high = ~Words{};        // of the lines' numbers
    std::array<std::uint32_t, kRoom> last_use{};  // in the log
    std::array<SectorKinds, kRoom> kinds{};
    std::array<Sectors, kRoom> sectors{};
    std::uint32_t passed_on = 0;  // lines that are in a later bucket as this one was full

    // A bit for each line of that number.
    std::uint32_t matches(std::uint64_t line) const {
      const auto equal = (low == static_cast<std::uint32_t>(line)) &
                         (high == static_cast<std::uint32_t>(line >> 32));
#if A2RT_HAS_X86_VECTORS
      return static_cast<std::uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(equal)));
#else
      return unsigned(equal[0] & 1) | unsigned(equal[1] & 2) | unsigned(equal[2] & 4) |
             unsigned(equal[3] & 8);
#endif
    }
    std::uint64_t line(std::uint32_t i) const { return std::uint64_t{high[i]} << 32 | low[i]; }
    void set_line(std::uint32_t i, std::uint64_t line) {
      low[i] = static_cast<std::uint32_t>(line);
      high[i] = static_cast<std::uint32_t>(line >> 32);
    }
  };
  static_assert(sizeof(Bucket) == 64);
  // Where a line is.
  struct Place {
    std::uint32_t bucket = 0, i = 0;
    bool found = false;
  };
  // A set's part of the log, in entries: no line's last use is before `oldest`.
  struct Set {
    std::uint32_t begin = 0, oldest = 0, end = 0, limit = 0;
    std::uint32_t lines = 0;
  };

  std::uint32_t home(std::uint64_t line) const {
    return static_cast<std::uint32_t>(mixed(line) >> hash_shift_);
  }
  std::uint32_t next(std::uint32_t bucket) const { return (bucket + 1) & bucket_mask_; }
  Place place_of(std::uint32_t number) const {
    return {number / kRoom, number % kRoom, number < places()};
  }
  A2RT_NOINLINE Entered put(Cycles now, Place place, std::uint64_t line, SectorMask sectors,
                            Traffic kind, bool dirty, SectorResidence& residence);
  Victim evict(Cycles now, Set& set, SectorResidence& residence);
  Place find_room(std::uint64_t line);
  void leave(Place place);

  void strike_out(Place place) {
    const std::uint32_t use = buckets_[place.bucket].last_use[place.i];
    struck_out_[use / 64] |= std::uint64_t{1} << use % 64;
  }
  void append(Set& set, Place place) {
    const std::uint32_t use = set.end++;
    log_[use] = place.bucket * kRoom + place.i;
    buckets_[place.bucket].last_use[place.i] = use;
    if (set.end == set.limit) [[unlikely]] {
      compact(set);
    }
  }
  A2RT_NOINLINE void compact(Set& set);

  std::vector<Bucket> buckets_;
  std::vector<std::uint32_t> log_;         // places: bucket * kRoom + i
  std::vector<std::uint64_t> struck_out_;  // a bit for each entry of the log
  std::vector<Set> sets_;
  Wrap wrap_;
  std::uint32_t bucket_mask_, hash_shift_, ways_;
};

}  // namespace a2rt::timing
