// Tags of a sectored set-associative cache with true LRU. One hash table over all lines makes a
// fully associative cache as cheap to look up as a 16-way one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "a2rt/base/units.h"
#include "a2rt/rt/event.h"

namespace a2rt::timing {

inline constexpr std::uint64_t kLineBytes = 128;
inline constexpr std::uint64_t kSectorBytes = 32;
inline constexpr std::uint32_t kSectorsPerLine = 4;

constexpr Address sector_of(Address a) { return Address{a.value & ~(kSectorBytes - 1)}; }
constexpr std::uint64_t line_of(Address a) { return a.value / kLineBytes; }
constexpr std::uint32_t sector_index(Address a) {
  return static_cast<std::uint32_t>(a.value / kSectorBytes) % kSectorsPerLine;
}

class TagStore {
 public:
  // `ways` 0 = fully associative. Throws UserError if the sizes do not divide.
  TagStore(Bytes capacity, std::uint32_t ways, const char* name);

  // A line thrown out; `dirty` has a bit per sector to be written below.
  struct Victim {
    std::uint64_t line = 0;
    std::uint8_t dirty = 0;
    std::array<Traffic, kSectorsPerLine> kinds{};
  };

  // True if the sector is valid; makes its line the most recent.
  bool touch(Address sector) {
    const std::uint32_t index = find(line_of(sector));
    if (index == kNoLine || (lines_[index].valid >> sector_index(sector) & 1) == 0) {
      return false;
    }
    make_newest(index);
    return true;
  }
  bool contains(Address sector) const;
  // Makes the sector valid (and dirty), allocating its line at the expense of the set's LRU line.
  std::optional<Victim> insert(Cycles now, Address sector, Traffic kind, bool dirty);
  void invalidate(Cycles now, Address sector);

  std::uint64_t line_count() const { return lines_.size(); }
  // Sector-cycles of residence by kind up to `now`: what the cache was filled with over time.
  std::array<std::uint64_t, static_cast<std::size_t>(Traffic::kCount)> residence(Cycles now) const;

 private:
  static constexpr std::uint32_t kNoLine = 0xffffffffu;
  struct Line {
    std::uint64_t tag = 0;
    std::uint32_t older = kNoLine, newer = kNoLine, hash_next = kNoLine, set = 0;
    std::uint8_t valid = 0, dirty = 0;
    bool used = false;
    std::array<Traffic, kSectorsPerLine> kinds{};
  };
  struct Set {
    std::uint32_t newest = kNoLine, oldest = kNoLine;
  };
  std::size_t hash(std::uint64_t line) const { return (line * 0x9e3779b97f4a7c15u) >> hash_shift_; }
  std::uint32_t find(std::uint64_t line) const {
    std::uint32_t index = buckets_[hash(line)];
    while (index != kNoLine && lines_[index].tag != line) {
      index = lines_[index].hash_next;
    }
    return index;
  }
  void make_newest(std::uint32_t index);
  void unlink_hash(std::uint32_t index);
  void change_residence(Cycles now, Traffic kind, int delta);

  std::uint32_t ways_ = 0;
  std::uint64_t sets_count_ = 1;
  std::uint32_t hash_shift_ = 0;
  std::vector<Line> lines_;
  std::vector<Set> sets_;
  std::vector<std::uint32_t> buckets_;
  struct Residence {
    std::uint64_t sectors = 0, sector_cycles = 0;
    Cycles since;
  };
  std::array<Residence, static_cast<std::size_t>(Traffic::kCount)> residence_{};
};

}  // namespace a2rt::timing
