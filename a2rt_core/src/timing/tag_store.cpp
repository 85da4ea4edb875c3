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
  lines_.resize(lines);
  links_.resize(lines);
  sets_.resize(lines / per_set);
  set_mask_ = std::has_single_bit(sets_.size()) ? sets_.size() - 1 : kNoMask;
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

void TagStore::change_residence(Cycles now, Traffic kind, int delta) {
  Residence& r = residence_[static_cast<std::size_t>(kind)];
  r.sector_cycles += r.sectors * (now.value - r.since.value);
  r.since = now;
  r.sectors = static_cast<std::uint64_t>(static_cast<std::int64_t>(r.sectors) + delta);
}

// Ends the residence of some of a line's sectors; neighbours are mostly of one kind.
void TagStore::forget(Cycles now, const Line& line, SectorMask sectors) {
  for (std::uint32_t rest = sectors; rest != 0;) {
    const Traffic kind = line.kinds[static_cast<std::size_t>(std::countr_zero(rest))];
    int count = 0;
    std::uint32_t others = 0;
    for (; rest != 0; rest &= rest - 1) {
      const auto s = static_cast<std::size_t>(std::countr_zero(rest));
      if (line.kinds[s] == kind) {
        ++count;
      } else {
        others |= 1u << s;
      }
    }
    change_residence(now, kind, -count);
    rest = others;
  }
}

std::optional<TagStore::Victim> TagStore::insert(Cycles now, Address line_address,
                                                 SectorMask sectors, Traffic kind, bool dirty) {
  const std::uint64_t tag = line_of(line_address);
  std::optional<Victim> victim;
  std::uint32_t index = find(tag);
  if (index == kNoLine) {
    index = sets_[set_of(tag)].oldest;
    Line& line = lines_[index];
    if (line.used) {
      victim = Victim{line.tag, line.dirty, line.kinds};
      forget(now, line, line.valid);
      unlink_hash(index);
    }
    line.tag = tag;
    line.used = true;
    line.valid = line.dirty = 0;
    line.hash_next = buckets_[hash(tag)];
    buckets_[hash(tag)] = index;
  }
  Line& line = lines_[index];
  forget(now, line, static_cast<SectorMask>(line.valid & sectors));
  int added = 0;
  for (std::uint32_t rest = sectors; rest != 0; rest &= rest - 1) {
    line.kinds[static_cast<std::size_t>(std::countr_zero(rest))] = kind;
    ++added;
  }
  change_residence(now, kind, added);
  line.valid |= sectors;
  if (dirty) {
    line.dirty |= sectors;
  }
  make_newest(index);
  return victim;
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
