// Lines and sectors, and what a cache was filled with over time.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "a2rt/base/bits.h"
#include "a2rt/base/units.h"
#include "a2rt/rt/event.h"

namespace a2rt::timing {

inline constexpr std::uint64_t kLineBytes = 128;
inline constexpr std::uint64_t kSectorBytes = 32;
inline constexpr std::uint32_t kSectorsPerLine = 4;

// Sectors of one line: bit s stands for sector s.
using SectorMask = std::uint8_t;
// What each sector of a line holds.
using SectorKinds = std::array<Traffic, kSectorsPerLine>;

constexpr Address sector_of(Address a) { return Address{a.value & ~(kSectorBytes - 1)}; }
constexpr std::uint64_t line_of(Address a) { return a.value / kLineBytes; }
constexpr std::uint32_t sector_index(Address a) {
  return static_cast<std::uint32_t>(a.value / kSectorBytes) % kSectorsPerLine;
}

// A line thrown out; `dirty` has a bit per sector to be written below.
struct Victim {
  std::uint64_t line = 0;
  SectorMask dirty = 0;
  SectorKinds kinds{};
};

// Sector-cycles that a cache's sectors spent in it, by kind.
class SectorResidence {
 public:
  using Totals = std::array<std::uint64_t, static_cast<std::size_t>(Traffic::kCount)>;

  // Sectors of one kind enter a line; those of them that are `valid` there make room.
  void replace(Cycles now, SectorKinds& kinds, SectorMask valid, SectorMask sectors, Traffic kind) {
    leave(now, kinds, static_cast<SectorMask>(valid & sectors));
    for_each_bit(sectors, [&](std::uint32_t s) { kinds[s] = kind; });
    change(now, kind, std::popcount(sectors));
  }
  // Some sectors of a line leave; neighbours are mostly of one kind.
  void leave(Cycles now, const SectorKinds& kinds, SectorMask sectors) {
    for (std::uint32_t rest = sectors; rest != 0;) {
      const Traffic kind = kinds[static_cast<std::size_t>(std::countr_zero(rest))];
      int count = 0;
      std::uint32_t others = 0;
      for (; rest != 0; rest &= rest - 1) {
        const auto s = static_cast<std::size_t>(std::countr_zero(rest));
        if (kinds[s] == kind) {
          ++count;
        } else {
          others |= 1u << s;
        }
      }
      change(now, kind, -count);
      rest = others;
    }
  }
  Totals totals(Cycles now) const {
    Totals all{};
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Kind& r = kinds_[k];
      all[k] = r.sector_cycles + r.sectors * (now.value - r.since.value);
    }
    return all;
  }

 private:
  struct Kind {
    std::uint64_t sectors = 0, sector_cycles = 0;
    Cycles since;
  };
  void change(Cycles now, Traffic kind, int delta) {
    Kind& r = kinds_[static_cast<std::size_t>(kind)];
    r.sector_cycles += r.sectors * (now.value - r.since.value);
    r.since = now;
    r.sectors = static_cast<std::uint64_t>(static_cast<std::int64_t>(r.sectors) + delta);
  }
  std::array<Kind, static_cast<std::size_t>(Traffic::kCount)> kinds_{};
};

}  // namespace a2rt::timing
