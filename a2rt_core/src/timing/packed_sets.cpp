#include "a2rt/timing/packed_sets.h"

#include "a2rt/base/error.h"

namespace a2rt::timing {

PackedSets::PackedSets(std::uint64_t sets, std::uint32_t ways)
    : sets_(sets),
      kinds_(sets * kMostWays),
      wrap_(sets),
      oldest_rank_(static_cast<std::uint8_t>(ways - 1)) {
  A2RT_CHECK(ways > 0 && ways <= kMostWays, "a packed set has 1 to 16 ways");
  for (Set& set : sets_) {
    set.line.fill(kUnused);
    for (std::uint32_t way = 0; way < kMostWays; ++way) {
      set.rank[way] = way < ways ? static_cast<std::uint8_t>(way) : std::uint8_t{0xff};
    }
  }
}

Entered PackedSets::put(Cycles now, std::uint32_t way, std::uint64_t line, SectorMask sectors,
                        Traffic kind, bool dirty, SectorResidence& residence) {
  const std::size_t index = wrap_.of(line);
  Set& set = sets_[index];
  std::optional<Victim> victim;
  if (way == kNoWay) {
    way = find_byte(set.rank, oldest_rank_,
                    [&](std::uint32_t w) { return set.rank[w] == oldest_rank_; });
    const SectorKinds& kinds = kinds_[index * kMostWays + way];
    if (set.line[way] != kUnused) {
      victim = Victim{set.line[way], set.dirty[way], kinds};
      residence.leave(now, kinds, set.valid[way]);
    }
    set.line[way] = line;
    set.digest[way] = digest_of(line);
    set.valid[way] = set.dirty[way] = 0;
  }
  residence.replace(now, kinds_[index * kMostWays + way], set.valid[way], sectors, kind);
  set.valid[way] |= sectors;
  if (dirty) {
    set.dirty[way] |= sectors;
  }
  make_newest(set, way);
  return {static_cast<std::uint32_t>(index * kMostWays + way), victim};
}

}  // namespace a2rt::timing
