// Tags of a sectored set-associative cache with true LRU. Up to 16 ways are kept in packed sets;
// for more, one hash table over all lines makes a fully associative cache as cheap to look up.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "a2rt/base/units.h"
#include "a2rt/rt/event.h"
#include "a2rt/timing/packed_sets.h"
#include "a2rt/timing/sectors.h"
#include "a2rt/timing/wrap.h"

namespace a2rt::timing {

class TagStore {
 public:
  // `ways` 0 = fully associative. Throws UserError if the sizes do not divide.
  TagStore(Bytes capacity, std::uint32_t ways, const char* name);

  // Those of the line's `wanted` sectors that are valid; if any, the line becomes the most recent.
  SectorMask touch(Address line, SectorMask wanted) {
    if (packed_) {
      return packed_->touch(line_of(line), wanted);
    }
    const std::uint32_t index = find(line_of(line));
    if (index == kNoLine) {
      return 0;
    }
    const auto found = static_cast<SectorMask>(lines_[index].valid & wanted);
    if (found != 0) {
      make_newest(index);
    }
    return found;
  }
  // The line will be looked up or inserted soon: brings what that touches into the host's caches.
  void prefetch(Address line) const {
    packed_ ? packed_->prefetch(line_of(line)) : __builtin_prefetch(&buckets_[hash(line_of(line))]);
  }
  // Those of the line's sectors that are valid.
  SectorMask valid(Address line) const {
    if (packed_) {
      return packed_->valid(line_of(line));
    }
    const std::uint32_t index = find(line_of(line));
    return index == kNoLine ? SectorMask{0} : lines_[index].valid;
  }
  bool contains(Address sector) const { return valid(sector) >> sector_index(sector) & 1; }
  // Makes the sectors valid (and dirty), allocating their line at the expense of the set's LRU one.
  std::optional<Victim> insert(Cycles now, Address line, SectorMask sectors, Traffic kind,
                               bool dirty);
  // As insert(), of what came from below: only those sectors that are not valid yet. Does nothing,
  // not even to the order of use, if all are.
  std::optional<Victim> fill(Cycles now, Address line, SectorMask sectors, Traffic kind) {
    const auto fresh = static_cast<SectorMask>(sectors & ~valid(line));
    return fresh == 0 ? std::nullopt : insert(now, line, fresh, kind, false);
  }

  // Sector-cycles of residence by kind up to `now`: what the cache was filled with over time.
  SectorResidence::Totals residence(Cycles now) const { return residence_.totals(now); }

 private:
  static constexpr std::uint32_t kNoLine = 0xffffffffu;
  struct Line {
    std::uint64_t tag = 0;
    std::uint32_t hash_next = kNoLine;
    SectorMask valid = 0, dirty = 0;
    bool used = false;
    SectorKinds kinds{};
  };
  // A line's neighbours in its set's order of use. Apart from the line: every use changes those of
  // three others, of which nothing else is wanted.
  struct Links {
    std::uint32_t older = kNoLine, newer = kNoLine;
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
  void make_newest(std::uint32_t index) {
    Links& links = links_[index];
    if (links.newer == kNoLine) {
      return;
    }
    Set& set = sets_[wrap_.of(lines_[index].tag)];
    links_[links.newer].older = links.older;
    (links.older != kNoLine ? links_[links.older].newer : set.oldest) = links.newer;
    links = {set.newest, kNoLine};
    links_[set.newest].newer = index;
    set.newest = index;
  }
  void unlink_hash(std::uint32_t index);

  Wrap wrap_;
  std::uint32_t hash_shift_ = 0;
  std::vector<Line> lines_;
  std::vector<Links> links_;  // by line
  std::vector<Set> sets_;
  std::vector<std::uint32_t> buckets_;
  std::optional<PackedSets> packed_;  // if so, nothing of the above
  SectorResidence residence_;
};

}  // namespace a2rt::timing
