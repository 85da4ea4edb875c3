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

constexpr std::uint64_t line_of(Address a) { return a.value / kLineBytes; }
constexpr std::uint32_t sector_index(Address a) {
  return static_cast<std::uint32_t>(a.value / kSectorBytes) % kSectorsPerLine;
}

inline std::uint32_t sectors_in(SectorMask mask) {
  // A table, as the project's oldest target has no instruction for it.
  constexpr std::array<std::uint8_t, 16> kOnes = {0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};
  return kOnes[mask & 0xf];
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
    change(now, kind, sectors_in(sectors));
  }
  // Some sectors of a line leave; neighbours are mostly of one kind.
  void leave(Cycles now, const SectorKinds& kinds, SectorMask sectors) {
    for (std::uint32_t rest = sectors; rest != 0;) {
      const Traffic kind = kinds[static_cast<std::size_t>(std::countr_zero(rest))];
      std::uint32_t same = 0;
      for (std::uint32_t s = 0; s < kSectorsPerLine; ++s) {
        same |= std::uint32_t{kinds[s] == kind} << s;
      }
      change(now, kind,
             -static_cast<std::int64_t>(sectors_in(static_cast<SectorMask>(rest & same))));
      rest &= ~same;
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
