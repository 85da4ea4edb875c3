#include "a2rt/timing/l1_cache.h"

#include <algorithm>
#include <bit>

namespace a2rt::timing {

L1Cache::L1Cache(const L1Config& config, Calendar& calendar, LowerLevel& lower, std::uint32_t sm)
    : config_(config),
      calendar_(calendar),
      lower_(lower),
      sm_(sm),
      tags_(config.capacity, config.ways, "l1"),
      banks_(config.banks, Budget(1)),
      mshrs_(config.mshrs),
      buckets_(1024, kNil) {
  for (std::uint32_t i = 0; i < config.mshrs; ++i) {
    mshrs_[i].next = i + 1 < config.mshrs ? i + 1 : kNil;
  }
  free_mshr_ = 0;
  bank_mask_ = std::has_single_bit(config.banks) ? config.banks - 1 : 0;
}

std::uint32_t L1Cache::find_mshr(Address sector) const {
  std::uint32_t index = buckets_[bucket(sector)];
  while (index != kNil && mshrs_[index].sector != sector) {
    index = mshrs_[index].next;
  }
  return index;
}

void L1Cache::add_waiter(Mshr& mshr, Component& client, std::uint32_t token, Cycles earliest) {
  std::uint32_t index = free_waiter_;
  if (index == kNil) {
    index = static_cast<std::uint32_t>(waiters_.size());
    waiters_.push_back({});
  } else {
    free_waiter_ = waiters_[index].next;
  }
  ++waiters_used_;
  waiters_[index] = {&client, token, kNil, earliest};
  if (mshr.first == kNil) {
    mshr.first = index;
  } else {
    waiters_[mshr.last].next = index;
  }
  mshr.last = index;
}

void L1Cache::wait_for_mshr(Component& client) {
  ++counts_.mshr_full;
  if (std::find(turned_away_.begin(), turned_away_.end(), &client) == turned_away_.end()) {
    turned_away_.push_back(&client);
  }
}

L1Cache::Reply L1Cache::read(Cycles now, Address sector, Traffic kind, Component& client,
                             std::uint32_t token) {
  const auto k = static_cast<std::size_t>(kind);
  Budget& bank = bank_of(sector);
  if (bank.left(now) == 0) {
    ++counts_.bank_conflicts;
    return Reply::kBankBusy;
  }
  const Cycles ready = now + config_.latency;
  if (tags_.touch(sector)) {
    bank.spend(now);
    ++counts_.reads[k];
    ++counts_.hits[k];
    calendar_.at(ready, client, kL1Data, token);
    return Reply::kAccepted;
  }
  if (const std::uint32_t pending = find_mshr(sector); pending != kNil) {
    Mshr& mshr = mshrs_[pending];
    if (mshr.merged >= config_.merges) {
      wait_for_mshr(client);
      return Reply::kMshrFull;
    }
    bank.spend(now);
    ++mshr.merged;
    ++counts_.reads[k];
    ++counts_.merges[k];
    add_waiter(mshr, client, token, ready);
    return Reply::kAccepted;
  }
  if (free_mshr_ == kNil) {
    wait_for_mshr(client);
    return Reply::kMshrFull;
  }
  bank.spend(now);
  ++counts_.reads[k];
  ++counts_.misses[k];
  const std::uint32_t index = free_mshr_;
  Mshr& mshr = mshrs_[index];
  free_mshr_ = mshr.next;
  ++mshrs_used_;
  mshr = {sector, kNil, kNil, buckets_[bucket(sector)], 1, kind};
  buckets_[bucket(sector)] = index;
  add_waiter(mshr, client, token, ready);
  lower_.request(ready, sm_, sector, kind, false);
  return Reply::kAccepted;
}

L1Cache::Reply L1Cache::write(Cycles now, Address sector, Traffic kind) {
  Budget& bank = bank_of(sector);
  if (bank.left(now) == 0) {
    ++counts_.bank_conflicts;
    return Reply::kBankBusy;
  }
  bank.spend(now);
  ++counts_.writes[static_cast<std::size_t>(kind)];
  if (kind == Traffic::kStack) {
    insert(now, sector, kind, true);
  } else {
    // Valid copies take the new data on the way down, so their state does not change.
    lower_.request(now + config_.latency, sm_, sector, kind, true);
  }
  return Reply::kAccepted;
}

void L1Cache::insert(Cycles now, Address sector, Traffic kind, bool dirty) {
  const auto victim = tags_.insert(now, sector, kind, dirty);
  if (!victim) {
    return;
  }
  ++counts_.evictions;
  for (std::uint32_t s = 0; s < kSectorsPerLine; ++s) {
    if (victim->dirty >> s & 1) {
      ++counts_.written_back;
      lower_.request(now, sm_, Address{victim->line * kLineBytes + s * kSectorBytes},
                     victim->kinds[s], true);
    }
  }
}

void L1Cache::fill(Cycles now, Address sector) {
  const std::uint32_t index = find_mshr(sector);
  A2RT_CHECK(index != kNil, "L1 was sent a sector it did not ask for");
  Mshr& mshr = mshrs_[index];
  std::uint32_t* link = &buckets_[bucket(sector)];
  while (*link != index) {
    link = &mshrs_[*link].next;
  }
  *link = mshr.next;
  ++counts_.fills;
  // A spill written meanwhile is newer than what comes from below.
  if (!tags_.contains(sector)) {
    insert(now, sector, mshr.kind, false);
  }
  std::uint32_t waiter = mshr.first;
  mshr.next = free_mshr_;
  free_mshr_ = index;
  --mshrs_used_;
  while (waiter != kNil) {
    const Waiter w = waiters_[waiter];
    waiters_[waiter].next = free_waiter_;
    free_waiter_ = waiter;
    --waiters_used_;
    waiter = w.next;
    calendar_.at(std::max(now, w.earliest), *w.client, kL1Data, w.token);
  }
  for (Component* client : turned_away_) {
    calendar_.at(now, *client, kL1Unblocked);
  }
  turned_away_.clear();
}

std::string L1Cache::dump() const {
  std::string text = "l1[" + std::to_string(sm_) + "]: " + std::to_string(mshrs_used_) + "/" +
                     std::to_string(config_.mshrs) + " MSHRs in use, " +
                     std::to_string(waiters_used_) + " reads waiting\n";
  std::uint32_t shown = 0;
  for (std::uint32_t head : buckets_) {
    for (std::uint32_t i = head; i != kNil && shown < 8; i = mshrs_[i].next, ++shown) {
      text += "  waits for sector " + std::to_string(mshrs_[i].sector.value) + " (" +
              std::to_string(mshrs_[i].merged) + " reads)\n";
    }
  }
  return text;
}

void L1Cache::check_drained() const {
  A2RT_CHECK(mshrs_used_ == 0 && waiters_used_ == 0, "L1 reads were never answered: " + dump());
  std::uint64_t reads = 0, answered = 0, misses = 0;
  for (std::size_t k = 0; k < kTrafficKinds; ++k) {
    reads += counts_.reads[k];
    answered += counts_.hits[k] + counts_.merges[k] + counts_.misses[k];
    misses += counts_.misses[k];
  }
  A2RT_CHECK(reads == answered, "L1 reads differ from hits + merges + misses");
  A2RT_CHECK(misses == counts_.fills, "L1 misses differ from fills");
}

}  // namespace a2rt::timing
