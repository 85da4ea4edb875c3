#include "a2rt/timing/hashed_sets.h"

#include "a2rt/base/error.h"

namespace a2rt::timing {

HashedSets::HashedSets(std::uint64_t sets, std::uint32_t ways)
    : buckets_(std::bit_ceil(sets * ways) * 2 / kRoom),
      sets_(sets),
      wrap_(sets),
      bucket_mask_(static_cast<std::uint32_t>(buckets_.size() - 1)),
      hash_shift_(static_cast<std::uint32_t>(std::countl_zero(buckets_.size())) + 1),
      ways_(ways) {
  A2RT_CHECK(sets * ways > 16 && sets * ways < 1u << 24, "too few or too many lines to be hashed");
  // Whole words of bits for each set.
  const std::uint32_t entries = (ways * kLogPerWay + 63) / 64 * 64;
  log_.resize(sets * entries);
  struck_out_.resize(log_.size() / 64);
  std::uint32_t begin = 0;
  for (Set& set : sets_) {
    set = {begin, begin, begin, begin + entries, 0};
    begin += entries;
  }
}

// Moves the uses that are not struck out to the log's begin, which makes room at its end.
void HashedSets::compact(Set& set) {
  std::uint32_t to = set.begin;
  for (std::uint32_t word = set.begin / 64; word < set.end / 64; ++word) {
    for (std::uint64_t rest = ~struck_out_[word]; rest != 0; rest &= rest - 1) {
      const std::uint32_t place =
          log_[word * 64 + static_cast<std::uint32_t>(std::countr_zero(rest))];
      log_[to] = place;
      buckets_[place / kRoom].last_use[place % kRoom] = to++;
    }
    struck_out_[word] = 0;
  }
  set.oldest = set.begin;
  set.end = to;
}

// Takes out the set's least recent line; it has one.
Victim HashedSets::evict(Cycles now, Set& set, SectorResidence& residence) {
  std::uint32_t word = set.oldest / 64;
  while (struck_out_[word] == ~std::uint64_t{0}) {
    ++word;
  }
  set.oldest = word * 64 + static_cast<std::uint32_t>(std::countr_one(struck_out_[word]));
  const std::uint32_t number = log_[set.oldest];
  const Place place{number / kRoom, number % kRoom, true};
  const Bucket& bucket = buckets_[place.bucket];
  const Sectors held = bucket.sectors[place.i];
  const Victim victim{bucket.line(place.i), held.dirty, bucket.kinds[place.i]};
  residence.leave(now, victim.kinds, held.valid);
  strike_out(place);
  leave(place);
  return victim;
}

// Finds the line a place that is free.
HashedSets::Place HashedSets::find_room(std::uint64_t line) {
  std::uint32_t b = home(line);
  std::uint32_t free = buckets_[b].matches(kUnused);
  while (free == 0) {
    ++buckets_[b].passed_on;
    b = next(b);
    free = buckets_[b].matches(kUnused);
  }
  const auto i = static_cast<std::uint32_t>(std::countr_zero(free));
  buckets_[b].set_line(i, line);
  buckets_[b].sectors[i] = {};
  return {b, i, true};
}

void HashedSets::leave(Place place) {
  Bucket& bucket = buckets_[place.bucket];
  for (std::uint32_t b = home(bucket.line(place.i)); b != place.bucket; b = next(b)) {
    --buckets_[b].passed_on;
  }
  bucket.set_line(place.i, kUnused);
}

Entered HashedSets::put(Cycles now, Place place, std::uint64_t line, SectorMask sectors,
                        Traffic kind, bool dirty, SectorResidence& residence) {
  Set& set = sets_[wrap_.of(line)];
  std::optional<Victim> victim;
  if (place.found) {
    strike_out(place);
  } else {
    if (set.lines == ways_) {
      victim = evict(now, set, residence);
    } else {
      ++set.lines;
    }
    place = find_room(line);
  }
  Bucket& bucket = buckets_[place.bucket];
  Sectors& held = bucket.sectors[place.i];
  residence.replace(now, bucket.kinds[place.i], held.valid, sectors, kind);
  held.valid = (held.valid | sectors) & 0xf;
  if (dirty) {
    held.dirty = (held.dirty | sectors) & 0xf;
  }
  append(set, place);
  return {place.bucket * kRoom + place.i, victim};
}

}  // namespace a2rt::timing
