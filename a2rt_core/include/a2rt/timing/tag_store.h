// Tags of a sectored set-associative cache with true LRU. Up to 16 ways are kept in packed sets,
// more in a hash table, which makes a fully associative cache as cheap to look up.
#pragma once

#include <cstdint>
#include <optional>

#include "a2rt/base/inline.h"
#include "a2rt/base/units.h"
#include "a2rt/rt/event.h"
#include "a2rt/timing/hashed_sets.h"
#include "a2rt/timing/packed_sets.h"
#include "a2rt/timing/sectors.h"

namespace a2rt::timing {

class TagStore {
 public:
  // `ways` 0 = fully associative. Throws UserError if the sizes do not divide.
  TagStore(Bytes capacity, std::uint32_t ways, const char* name);

  // Where the line is and which of its sectors are valid; its place is below places().
  std::uint32_t places() const { return packed_ ? packed_->places() : hashed_->places(); }
  A2RT_INLINE Held look(Address line) const {
    return packed_ ? packed_->look(line_of(line)) : hashed_->look(line_of(line));
  }
  // A line found there becomes the most recent.
  void use(Address line, std::uint32_t place) {
    packed_ ? packed_->use(place) : hashed_->use(line_of(line), place);
  }
  // Makes the sectors valid (and dirty), after look(): allocates the line, if it is nowhere, at the
  // expense of the set's LRU one.
  Entered enter(Cycles now, Held held, Address line, SectorMask sectors, Traffic kind, bool dirty) {
    return packed_
               ? packed_->enter(now, held.place, line_of(line), sectors, kind, dirty, residence_)
               : hashed_->enter(now, held.place, line_of(line), sectors, kind, dirty, residence_);
  }

  // Those of the line's `wanted` sectors that are valid; if any, the line becomes the most recent.
  SectorMask touch(Address line, SectorMask wanted) {
    const Held held = look(line);
    const auto found = static_cast<SectorMask>(held.valid & wanted);
    if (found != 0) {
      use(line, held.place);
    }
    return found;
  }
  // Those of the line's sectors that are valid.
  SectorMask valid(Address line) const { return look(line).valid; }
  bool contains(Address sector) const { return valid(sector) >> sector_index(sector) & 1; }
  std::optional<Victim> insert(Cycles now, Address line, SectorMask sectors, Traffic kind,
                               bool dirty) {
    return enter(now, look(line), line, sectors, kind, dirty).victim;
  }
  // As insert(), of what came from below: only those sectors that are not valid yet. Does nothing,
  // not even to the order of use, if all are.
  std::optional<Victim> fill(Cycles now, Address line, SectorMask sectors, Traffic kind) {
    const Held held = look(line);
    const auto fresh = static_cast<SectorMask>(sectors & ~held.valid);
    return fresh == 0 ? std::nullopt : enter(now, held, line, fresh, kind, false).victim;
  }

  // The line will be looked up or inserted soon: brings what that touches into the host's caches.
  void prefetch(Address line) const {
    packed_ ? packed_->prefetch(line_of(line)) : hashed_->prefetch(line_of(line));
  }
  // Where the line is likely to be.
  std::uint32_t guess(Address line) const {
    return packed_ ? packed_->guess(line_of(line)) : hashed_->guess(line_of(line));
  }

  // Sector-cycles of residence by kind up to `now`: what the cache was filled with over time.
  SectorResidence::Totals residence(Cycles now) const { return residence_.totals(now); }

 private:
  // One of the two.
  std::optional<PackedSets> packed_;
  std::optional<HashedSets> hashed_;
  SectorResidence residence_;
};

}  // namespace a2rt::timing
