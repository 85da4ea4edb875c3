#include "a2rt/timing/l1_cache.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace a2rt::timing {
namespace {

// The lowest `n` sectors of the mask.
SectorMask lowest(SectorMask mask, std::uint32_t n) {
  if (n >= kSectorsPerLine) [[likely]] {
    return mask;
  }
  SectorMask kept = 0;
  for (; n > 0 && mask != 0; --n) {
    kept = static_cast<SectorMask>(kept | (mask & -mask));
    mask = static_cast<SectorMask>(mask & (mask - 1));
  }
  return kept;
}

// When a message of sectors that follow each other a cycle apart can leave: none goes before its
// own time.
Cycles departure(SectorMask sectors, const SectorTimes& ready) {
  // The last one's, as the first one's may be before the run's beginning.
  Cycles last;
  std::uint64_t behind = sectors_in(sectors);
  for_each_bit(sectors,
               [&](std::uint32_t s) { last = std::max(last, ready[s] + Cycles{--behind}); });
  return last - Cycles{sectors_in(sectors) - 1};
}

}  // namespace

L1Cache::L1Cache(const L1Config& config, LowerLevel& lower, std::uint32_t sm)
    : config_(config),
      lower_(lower),
      sm_(sm),
      reserves_(lower.answers_at_once()),
      tags_(config.capacity, config.ways, "l1"),
      banks_(config.banks),
      ahead_(reserves_ ? tags_.places() + 1 : 0),
      in_flight_(reserves_ ? config.mshrs : 1) {
  buckets_.fill(kNil);
}

// What points to the line's entry, or to nothing at the end of its bucket.
std::uint32_t* L1Cache::find(std::uint64_t line) {
  std::uint32_t* link = &buckets_[bucket(line)];
  while (*link != kNil && pending_[*link].line != line) {
    link = &pending_[*link].next;
  }
  return link;
}

std::uint32_t L1Cache::obtain(std::uint64_t line, Traffic kind) {
  std::uint32_t index = free_pending_;
  if (index == kNil) {
    index = static_cast<std::uint32_t>(pending_.size());
    pending_.push_back({});
  } else {
    free_pending_ = pending_[index].next;
  }
  std::uint32_t& head = buckets_[bucket(line)];
  pending_[index] = {line, {}, kNil, kNil, head, 0, 0, kind};
  head = index;
  return index;
}

void L1Cache::release(std::uint32_t& link) {
  const std::uint32_t index = link;
  Pending& pending = pending_[index];
  A2RT_CHECK(pending.waiting == 0, "L1 reads wait for a sector that nobody fetches");
  link = pending.next;
  pending.next = free_pending_;
  free_pending_ = index;
}

void L1Cache::add_waiter(Pending& pending, const Waiter& waiter) {
  ++waiters_used_;
  ++pending.waiting;
  if (pending.sectors == 0) {
    pending.first = waiter;
    return;
  }
  std::uint32_t index = free_waiter_;
  if (index == kNil) {
    index = static_cast<std::uint32_t>(waiters_.size());
    waiters_.push_back({});
  } else {
    free_waiter_ = waiters_[index].next;
  }
  waiters_[index] = {waiter, kNil};
  (pending.later == kNil ? pending.later : waiters_[pending.last].next) = index;
  pending.last = index;
}

// Those of the sectors being fetched that another read may wait for.
SectorMask L1Cache::mergeable(const Pending& pending, SectorMask sectors) const {
  if (pending.waiting < config_.merges) [[likely]] {
    return sectors;
  }
  std::array<std::uint32_t, kSectorsPerLine> merged{};
  const auto count = [&](SectorMask wanted) {
    for_each_bit(wanted, [&](std::uint32_t s) { ++merged[s]; });
  };
  count(pending.first.wanted);
  for (std::uint32_t i = pending.later; i != kNil; i = waiters_[i].next) {
    count(waiters_[i].waiter.wanted);
  }
  SectorMask free = 0;
  for_each_bit(sectors, [&](std::uint32_t s) {
    free = static_cast<SectorMask>(free | unsigned{merged[s] < config_.merges} << s);
  });
  return free;
}

void L1Cache::turn_away(L1Client& client) {
  ++counts_.mshr_full;
  if (std::find(turned_away_.begin(), turned_away_.end(), &client) == turned_away_.end()) {
    turned_away_.push_back(&client);
  }
}

// Each sector in the first cycle in which the port and its bank are free.
void L1Cache::enter_one_by_one(Cycles now, Port& port, Address line, SectorMask sectors,
                               SectorTimes& ready) {
  const std::uint64_t base = line.value / kSectorBytes;
  for_each_bit(sectors, [&](std::uint32_t s) {
    const std::size_t bank = banks_.of(base + s);
    const Cycles wanted = port.next(now);
    Cycles at = banks_.free_from(bank, wanted);
    while (port.next(at) != at) {  // between edges of the port's clock
      at = banks_.free_from(bank, port.next(at));
    }
    banks_.take(bank, at);
    port.use(at);
    counts_.bank_conflicts += at.value - wanted.value;
    ready[s] = at + config_.latency;
  });
}

// Some of the sectors are not there: as many as there are MSHRs for are fetched.
void L1Cache::miss(Cycles now, Port& port, Address line, SectorMask missing, Traffic kind,
                   L1Client& client, std::uint32_t token, Lookup& result) {
  std::uint32_t index = *find(line_of(line));
  SectorMask merging = 0, fresh = missing;
  if (index != kNil) [[unlikely]] {
    const Pending& pending = pending_[index];
    merging = mergeable(pending, static_cast<SectorMask>(missing & pending.sectors));
    fresh = static_cast<SectorMask>(missing & ~pending.sectors);
  }
  fresh = lowest(fresh, config_.mshrs - mshrs_used_);
  const auto taken = static_cast<SectorMask>(merging | fresh);
  if (taken != missing) [[unlikely]] {
    result.mshrs_full = true;
    turn_away(client);
  }
  result.accepted = static_cast<SectorMask>(result.hits | taken);
  if (result.accepted == 0) {
    return;
  }
  enter(now, port, line, result.accepted, result.ready);
  if (taken == 0) {
    return;
  }
  if (index == kNil) {
    index = obtain(line_of(line), kind);
  }
  const auto last = static_cast<std::size_t>(std::bit_width(unsigned{taken})) - 1;
  add_waiter(pending_[index], {&client, result.ready[last], token, taken});
  if (merging != 0) {
    counts_.merges[static_cast<std::size_t>(kind)] += sectors_in(merging);
  }
  if (fresh != 0) {
    pending_[index].sectors = static_cast<SectorMask>(pending_[index].sectors | fresh);
    mshrs_used_ += sectors_in(fresh);
    counts_.misses[static_cast<std::size_t>(kind)] += sectors_in(fresh);
    lower_.request(departure(fresh, result.ready), sm_, line, fresh, kind, false);
  }
}

// Puts sectors into a line of the tags, which may be a new one.
L1Cache::Ahead& L1Cache::enter_ahead(Cycles now, Held held, Address line, SectorMask sectors,
                                     Traffic kind, bool dirty) {
  const Entered entered = tags_.enter(now, held, line, sectors, kind, dirty);
  count_victim(now, entered.victim);
  Ahead& ahead = ahead_[entered.place];
  if (entered.place != held.place) {
    ahead = {};
  }
  return ahead;
}

// Some of the sectors miss, or data of the line is on its way.
Cycles L1Cache::wait_for_below(Cycles leaves, Cycles looked_up, Held held, Address line,
                               SectorMask sectors, Traffic kind) {
  const auto k = static_cast<std::size_t>(kind);
  const auto present = static_cast<SectorMask>(held.valid & sectors);
  const Arrival coming = ahead_[held.place].from_below.after(looked_up, 0);
  const auto merged = static_cast<SectorMask>(present & coming.sectors());
  counts_.merges[k] += sectors_in(merged);
  counts_.hits[k] += sectors_in(static_cast<SectorMask>(present ^ merged));
  const Cycles ready = merged != 0 ? coming.there() : looked_up;
  if (present != 0) {
    tags_.use(line, held.place);
  }
  const auto missing = static_cast<SectorMask>(sectors ^ present);
  return missing == 0 ? ready
                      : std::max(ready, miss_ahead(leaves, looked_up, held, line, missing, kind));
}

Cycles L1Cache::miss_ahead(Cycles leaves, Cycles looked_up, Held held, Address line,
                           SectorMask missing, Traffic kind) {
  const std::uint32_t n = sectors_in(missing);
  if (n > config_.mshrs) [[unlikely]] {
    Cycles last;
    for_each_bit(missing, [&](std::uint32_t s) {
      const auto one = static_cast<SectorMask>(1u << s);
      last = std::max(last, miss_ahead(leaves, looked_up, tags_.look(line), line, one, kind));
    });
    return last;
  }
  const auto k = static_cast<std::size_t>(kind);
  counts_.misses[k] += n;
  counts_.fills += n;
  const Cycles begin = in_flight_.begin(leaves, n);
  counts_.mshr_full += begin > leaves;
  const Cycles there = lower_.read(begin, sm_, line, missing, kind) + Cycles{n - 1};
  in_flight_.add(n, there);
  Arrival& from_below = enter_ahead(looked_up, held, line, missing, kind, false).from_below;
  from_below = from_below.after(looked_up, 0).with(0, missing, there);
  return std::max(looked_up, there);
}

void L1Cache::write(Cycles now, Port& port, Address line, SectorMask sectors, Traffic kind) {
  SectorTimes sent{};
  banks_.advance(now);
  enter(now, port, line, sectors, sent);
  write_from(departure(sectors, sent), now, line, sectors, kind);
}

// The first of the sectors leaves for the levels below at `leaves`, if they have to know.
void L1Cache::write_from(Cycles leaves, Cycles now, Address line, SectorMask sectors,
                         Traffic kind) {
  counts_.writes[static_cast<std::size_t>(kind)] += sectors_in(sectors);
  if (kind == Traffic::kStack) {
    if (reserves_) {
      enter_ahead(now, tags_.look(line), line, sectors, kind, true);
    } else {
      count_victim(now, tags_.insert(now, line, sectors, kind, true));
    }
  } else {
    // Valid copies take the new data on the way down, so their state does not change.
    lower_.request(leaves, sm_, line, sectors, kind, true);
  }
}

void L1Cache::count_victim(Cycles now, const std::optional<Victim>& victim) {
  if (!victim) {
    return;
  }
  ++counts_.evictions;
  counts_.written_back += sectors_in(victim->dirty);
  for_each_bit(victim->dirty, [&](std::uint32_t s) {
    lower_.request(now, sm_, Address{victim->line * kLineBytes}, static_cast<SectorMask>(1u << s),
                   victim->kinds[s], true);
  });
}

// Tells every waiter which of its sectors came, and when. Clients only note it; they read again in
// their own time.
void L1Cache::answer(Cycles now, Pending& pending, SectorMask sectors) {
  const auto tell = [&](Waiter& w) {
    const auto got = static_cast<SectorMask>(w.wanted & sectors);
    if (got == 0) {
      return;
    }
    w.wanted = static_cast<SectorMask>(w.wanted & ~got);
    const std::uint32_t served = w.wanted == 0;
    pending.waiting -= served;
    waiters_used_ -= served;
    SectorTimes ready;
    for (std::uint32_t s = 0; s < kSectorsPerLine; ++s) {
      ready[s] = std::max(now + Cycles{kInTurn[sectors].after[s]}, w.earliest);
    }
    w.client->arrived(now, w.token, got, ready);
  };
  tell(pending.first);
  std::uint32_t* link = &pending.later;
  pending.last = kNil;
  while (*link != kNil) {
    const std::uint32_t index = *link;
    LaterWaiter& later = waiters_[index];
    tell(later.waiter);
    if (later.waiter.wanted == 0) {
      *link = later.next;
      later.next = free_waiter_;
      free_waiter_ = index;
    } else {
      pending.last = index;
      link = &later.next;
    }
  }
}

void L1Cache::fill(Cycles now, Address line, SectorMask sectors) {
  std::uint32_t& link = *find(line_of(line));
  A2RT_CHECK(link != kNil && (pending_[link].sectors & sectors) == sectors,
             "L1 was sent a sector it did not ask for");
  Pending& pending = pending_[link];
  counts_.fills += sectors_in(sectors);
  mshrs_used_ -= sectors_in(sectors);
  // A spill written meanwhile is newer than what comes from below.
  count_victim(now, tags_.fill(now, line, sectors, pending.kind));
  pending.sectors = static_cast<SectorMask>(pending.sectors & ~sectors);
  answer(now, pending, sectors);
  if (pending.sectors == 0) {
    release(link);
  }
  if (!turned_away_.empty()) {
    std::vector<L1Client*> again;
    again.swap(turned_away_);
    for (L1Client* client : again) {
      client->unblocked(now);
    }
  }
}

std::string L1Cache::dump() const {
  std::string text = "l1[" + std::to_string(sm_) + "]: " + std::to_string(mshrs_used_) + "/" +
                     std::to_string(config_.mshrs) + " MSHRs in use, " +
                     std::to_string(waiters_used_) + " reads waiting\n";
  std::uint32_t shown = 0;
  for (const std::uint32_t head : buckets_) {
    for (std::uint32_t i = head; i != kNil && shown < 8; i = pending_[i].next, ++shown) {
      text += "  waits for " + std::to_string(sectors_in(pending_[i].sectors)) +
              " sectors of line " + std::to_string(pending_[i].line) + "\n";
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
