#include "a2rt/timing/tag_store.h"

#include <bit>
#include <string>

#include "a2rt/base/error.h"

namespace a2rt::timing {

TagStore::TagStore(Bytes capacity, std::uint32_t ways, const char* name) {
  const std::uint64_t lines = capacity.value / kLineBytes;
  ways_ = ways == 0 ? static_cast<std::uint32_t>(lines) : ways;
  if (lines == 0 || capacity.value % kLineBytes != 0 || lines % ways_ != 0) {
    throw UserError(std::string(name) + ": capacity of " + std::to_string(capacity.value) +
                    " bytes is not a whole number of sets of " + std::to_string(ways_) +
                    " lines of " + std::to_string(kLineBytes) + " bytes; change capacity or ways");
  }
  sets_count_ = lines / ways_;
  lines_.resize(lines);
  sets_.resize(sets_count_);
  for (std::uint32_t i = 0; i < lines; ++i) {
    lines_[i].set = i / ways_;
    Set& set = sets_[lines_[i].set];
    lines_[i].newer = set.oldest;
    if (set.oldest != kNoLine) {
      lines_[set.oldest].older = i;
    } else {
      set.newest = i;
    }
    set.oldest = i;
  }
  const std::uint64_t buckets = std::bit_ceil(lines * 2);
  buckets_.assign(buckets, kNoLine);
  hash_shift_ = 64 - static_cast<std::uint32_t>(std::bit_width(buckets) - 1);
}

void TagStore::make_newest(std::uint32_t index) {
  Set& set = sets_[lines_[index].set];
  if (set.newest == index) {
    return;
  }
  Line& line = lines_[index];
  // Not the newest, so a newer one exists.
  lines_[line.newer].older = line.older;
  if (line.older != kNoLine) {
    lines_[line.older].newer = line.newer;
  } else {
    set.oldest = line.newer;
  }
  line.older = set.newest;
  line.newer = kNoLine;
  lines_[set.newest].newer = index;
  set.newest = index;
}

bool TagStore::contains(Address sector) const {
  const std::uint32_t index = find(line_of(sector));
  return index != kNoLine && (lines_[index].valid >> sector_index(sector) & 1) != 0;
}

void TagStore::unlink_hash(std::uint32_t index) {
  std::uint32_t* link = &buckets_[hash(lines_[index].tag)];
  while (*link != index) {
    link = &lines_[*link].hash_next;
  }
  *link = lines_[index].hash_next;
}

void TagStore::change_residence(Cycles now, Traffic kind, int delta) {
  Residence& r = residence_[static_cast<std::size_t>(kind)];
  r.sector_cycles += r.sectors * (now.value - r.since.value);
  r.since = now;
  r.sectors = static_cast<std::uint64_t>(static_cast<std::int64_t>(r.sectors) + delta);
}

std::optional<TagStore::Victim> TagStore::insert(Cycles now, Address sector, Traffic kind,
                                                 bool dirty) {
  const std::uint64_t tag = line_of(sector);
  const auto bit = static_cast<std::uint8_t>(1u << sector_index(sector));
  std::optional<Victim> victim;
  std::uint32_t index = find(tag);
  if (index == kNoLine) {
    index = sets_[tag % sets_count_].oldest;
    Line& line = lines_[index];
    if (line.used) {
      victim = Victim{line.tag, line.dirty, line.kinds};
      for (std::uint32_t s = 0; s < kSectorsPerLine; ++s) {
        if (line.valid >> s & 1) {
          change_residence(now, line.kinds[s], -1);
        }
      }
      unlink_hash(index);
    }
    line.tag = tag;
    line.used = true;
    line.valid = line.dirty = 0;
    line.hash_next = buckets_[hash(tag)];
    buckets_[hash(tag)] = index;
  }
  Line& line = lines_[index];
  Traffic& held = line.kinds[sector_index(sector)];
  if (line.valid & bit) {
    if (held != kind) {
      change_residence(now, held, -1);
      change_residence(now, kind, 1);
    }
  } else {
    change_residence(now, kind, 1);
  }
  held = kind;
  line.valid |= bit;
  if (dirty) {
    line.dirty |= bit;
  }
  make_newest(index);
  return victim;
}

void TagStore::invalidate(Cycles now, Address sector) {
  const std::uint32_t index = find(line_of(sector));
  const auto bit = static_cast<std::uint8_t>(1u << sector_index(sector));
  if (index == kNoLine || (lines_[index].valid & bit) == 0) {
    return;
  }
  change_residence(now, lines_[index].kinds[sector_index(sector)], -1);
  lines_[index].valid = static_cast<std::uint8_t>(lines_[index].valid & ~bit);
  lines_[index].dirty = static_cast<std::uint8_t>(lines_[index].dirty & ~bit);
}

std::array<std::uint64_t, static_cast<std::size_t>(Traffic::kCount)> TagStore::residence(
    Cycles now) const {
  std::array<std::uint64_t, static_cast<std::size_t>(Traffic::kCount)> all{};
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Residence& r = residence_[k];
    all[k] = r.sector_cycles + r.sectors * (now.value - r.since.value);
  }
  return all;
}

}  // namespace a2rt::timing
