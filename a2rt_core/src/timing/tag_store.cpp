#include "a2rt/timing/tag_store.h"

#include <bit>
#include <string>

#include "a2rt/base/error.h"

namespace a2rt::timing {

TagStore::TagStore(Bytes capacity, std::uint32_t ways, const char* name) {
  const std::uint64_t lines = capacity.value / kLineBytes;
  const std::uint64_t per_set = ways == 0 ? lines : ways;
  if (lines == 0 || capacity.value % kLineBytes != 0 || lines % per_set != 0) {
    throw UserError(std::string(name) + ": capacity of " + std::to_string(capacity.value) +
                    " bytes is not a whole number of sets of " + std::to_string(per_set) +
                    " lines of " + std::to_string(kLineBytes) + " bytes; change capacity or ways");
  }
  if (per_set <= PackedSets::kMostWays) {
    packed_.emplace(lines / per_set, static_cast<std::uint32_t>(per_set));
    return;
  }
  lines_.resize(lines);
  links_.resize(lines);
  sets_.resize(lines / per_set);
  wrap_ = Wrap(sets_.size());
  for (std::uint32_t i = 0; i < lines; ++i) {
    Set& set = sets_[i / per_set];
    lines_[i].tag = i / per_set;  // never used, but in its set
    links_[i].newer = set.oldest;
    if (set.oldest != kNoLine) {
      links_[set.oldest].older = i;
    } else {
      set.newest = i;
    }
    set.oldest = i;
  }
  const std::uint64_t buckets = std::bit_ceil(lines * 2);
  buckets_.assign(buckets, kNoLine);
  hash_shift_ = 64 - static_cast<std::uint32_t>(std::bit_width(buckets) - 1);
}

void TagStore::unlink_hash(std::uint32_t index) {
  std::uint32_t* link = &buckets_[hash(lines_[index].tag)];
  while (*link != index) {
    link = &lines_[*link].hash_next;
  }
  *link = lines_[index].hash_next;
}

std::optional<Victim> TagStore::insert(Cycles now, Address line_address, SectorMask sectors,
                                       Traffic kind, bool dirty) {
  if (packed_) {
    return packed_->insert(now, line_of(line_address), sectors, kind, dirty, residence_);
  }
  const std::uint64_t tag = line_of(line_address);
  std::optional<Victim> victim;
  std::uint32_t index = find(tag);
  if (index == kNoLine) {
    index = sets_[wrap_.of(tag)].oldest;
    Line& line = lines_[index];
    if (line.used) {
      victim = Victim{line.tag, line.dirty, line.kinds};
      residence_.leave(now, line.kinds, line.valid);
      unlink_hash(index);
    }
    line.tag = tag;
    line.used = true;
    line.valid = line.dirty = 0;
    line.hash_next = buckets_[hash(tag)];
    buckets_[hash(tag)] = index;
  }
  Line& line = lines_[index];
  residence_.replace(now, line.kinds, line.valid, sectors, kind);
  line.valid |= sectors;
  if (dirty) {
    line.dirty |= sectors;
  }
  make_newest(index);
  return victim;
}

}  // namespace a2rt::timing
