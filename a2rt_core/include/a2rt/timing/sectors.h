// Lines and sectors, and what a cache was filled with over time.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include "a2rt/base/bits.h"
#include "a2rt/base/units.h"
#include "a2rt/rt/event.h"

namespace a2rt::timing {

inline constexpr std::uint64_t kLineBytes = 128;
inline constexpr std::uint64_t kSectorBytes = 32;
inline constexpr std::uint32_t kSectorsPerLine = 4;

// Sectors of one line: bit s stands for sector s.
using SectorMask = std::uint8_t;

// What each sector of a line holds, in four bits each.
class SectorKinds {
 public:
  Traffic operator[](std::uint32_t sector) const {
    return static_cast<Traffic>(bits_ >> sector * 4 & 0xf);
  }
  void set(SectorMask sectors, Traffic kind) {
    bits_ =
        static_cast<std::uint16_t>((bits_ & ~kSpread[sectors]) | (kSpread[sectors] & all(kind)));
  }
  bool are(SectorMask sectors, Traffic kind) const {
    return ((bits_ ^ all(kind)) & kSpread[sectors]) == 0;
  }

 private:
  static_assert(static_cast<std::uint32_t>(Traffic::kCount) <= 16);
  static constexpr std::uint32_t all(Traffic kind) {
    return static_cast<std::uint32_t>(kind) * 0x1111;
  }
  // For each mask of sectors: the bits of those in it.
  static constexpr auto kSpread = [] {
    std::array<std::uint16_t, 1u << kSectorsPerLine> table{};
    for (std::uint32_t m = 0; m < table.size(); ++m) {
      for_each_bit(m,
                   [&](std::uint32_t s) { table[m] |= static_cast<std::uint16_t>(0xf << s * 4); });
    }
    return table;
  }();
  std::uint16_t bits_ = 0;
};

// A line's or sector's number for a hash table; the upper bits are the well mixed ones.
constexpr std::uint64_t mixed(std::uint64_t number) { return number * 0x9e3779b97f4a7c15u; }
constexpr std::uint64_t line_of(Address a) { return a.value / kLineBytes; }
constexpr std::uint32_t sector_index(Address a) {
  return static_cast<std::uint32_t>(a.value / kSectorBytes) % kSectorsPerLine;
}

inline std::uint32_t sectors_in(SectorMask mask) {
  // A table, as the project's oldest target has no instruction for it.
  constexpr std::array<std::uint8_t, 16> kOnes = {0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};
  return kOnes[mask & 0xf];
}

// Where a cache holds a line, and which of its sectors are valid.
struct Held {
  std::uint32_t place = 0;  // below places(); that many if the line is nowhere
  SectorMask valid = 0;
};

// A line thrown out; `dirty` has a bit per sector to be written below.
struct Victim {
  std::uint64_t line = 0;
  SectorMask dirty = 0;
  SectorKinds kinds{};
};

// Where a line was put, and what made room for it.
struct Entered {
  std::uint32_t place = 0;
  std::optional<Victim> victim;
};

// Sector-cycles that a cache's sectors spent in it, by kind.
class SectorResidence {
 public:
  using Totals = std::array<std::uint64_t, static_cast<std::size_t>(Traffic::kCount)>;

  // Sectors of one kind enter a line; those of them that are `valid` there make room.
  void replace(Cycles now, SectorKinds& kinds, SectorMask valid, SectorMask sectors, Traffic kind) {
    leave(now, kinds, static_cast<SectorMask>(valid & sectors));
    kinds.set(sectors, kind);
    change(now, kind, sectors_in(sectors));
  }
  // Some sectors of a line leave; neighbours are mostly of one kind.
  void leave(Cycles now, const SectorKinds& kinds, SectorMask sectors) {
    while (sectors != 0) {
      const Traffic kind = kinds[static_cast<std::uint32_t>(std::countr_zero(sectors))];
      const auto lowest = static_cast<SectorMask>(sectors & -sectors);
      const SectorMask same = kinds.are(sectors, kind) ? sectors : lowest;
      change(now, kind, -static_cast<std::int64_t>(sectors_in(same)));
      sectors = static_cast<SectorMask>(sectors ^ same);
    }
  }
  Totals totals(Cycles now) const {
    Totals all{};
    for (std::size_t k = 0; k < all.size(); ++k) {
      all[k] = kinds_[k].sectors * now.value - kinds_[k].since;
    }
    return all;
  }

 private:
  // Those that are there, and the sum of the cycles since when: wraps around, as the difference
  // that is wanted does not.
  struct Kind {
    std::uint64_t sectors = 0, since = 0;
  };
  void change(Cycles now, Traffic kind, std::int64_t delta) {
    Kind& r = kinds_[static_cast<std::size_t>(kind)];
    r.sectors += static_cast<std::uint64_t>(delta);
    r.since += static_cast<std::uint64_t>(delta) * now.value;
  }
  std::array<Kind, static_cast<std::size_t>(Traffic::kCount)> kinds_{};
};

}  // namespace a2rt::timing
