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

  // Those of the line's `wanted` sectors that are valid; if any, the line becomes the most recent.
  SectorMask touch(Address line, SectorMask wanted) {
    return packed_ ? packed_->touch(line_of(line), wanted) : hashed_->touch(line_of(line), wanted);
  }
  // The line will be looked up or inserted soon: brings what that touches into the host's caches.
  void prefetch(Address line) const {
    packed_ ? packed_->prefetch(line_of(line)) : hashed_->prefetch(line_of(line));
  }
  // Those of the line's sectors that are valid.
  SectorMask valid(Address line) const {
    return packed_ ? packed_->valid(line_of(line)) : hashed_->valid(line_of(line));
  }
  // touch() in two steps, between which the line's place is known.
  std::uint32_t places() const { return packed_ ? packed_->places() : hashed_->places(); }
  // Where the line is likely to be.
  std::uint32_t guess(Address line) const {
    return packed_ ? packed_->guess(line_of(line)) : hashed_->guess(line_of(line));
  }
  A2RT_INLINE Held look(Address line) const {
    return packed_ ? packed_->look(line_of(line)) : hashed_->look(line_of(line));
  }
  void use(Address line, std::uint32_t place) {
    packed_ ? packed_->use(place) : hashed_->use(line_of(line), place);
  }
  bool contains(Address sector) const { return valid(sector) >> sector_index(sector) & 1; }
  // Makes the sectors valid (and dirty), allocating their line at the expense of the set's LRU one.
  std::optional<Victim> insert(Cycles now, Address line, SectorMask sectors, Traffic kind,
                               bool dirty) {
    return packed_ ? packed_->insert(now, line_of(line), sectors, kind, dirty, residence_)
                   : hashed_->insert(now, line_of(line), sectors, kind, dirty, residence_);
  }
  // As insert(), after look().
  Entered enter(Cycles now, Held held, Address line, SectorMask sectors, Traffic kind, bool dirty) {
    return packed_
               ? packed_->enter(now, held.place, line_of(line), sectors, kind, dirty, residence_)
               : hashed_->enter(now, held.place, line_of(line), sectors, kind, dirty, residence_);
  }
  // As insert(), of what came from below: only those sectors that are not valid yet. Does nothing,
  // not even to the order of use, if all are.
  std::optional<Victim> fill(Cycles now, Address line, SectorMask sectors, Traffic kind) {
    return packed_ ? packed_->fill(now, line_of(line), sectors, kind, residence_)
                   : hashed_->fill(now, line_of(line), sectors, kind, residence_);
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
