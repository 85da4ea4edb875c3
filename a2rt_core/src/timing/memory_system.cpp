#include "a2rt/timing/memory_system.h"

#include <algorithm>

namespace a2rt::timing {
namespace {

constexpr std::uint32_t kMshrHashShift = 54;
constexpr std::size_t kMshrBuckets = std::size_t{1} << (64 - kMshrHashShift);

std::uint32_t first_sector(SectorMask sectors) {
  return static_cast<std::uint32_t>(std::countr_zero(sectors));
}

}  // namespace

MemorySystem::MemorySystem(const MachineConfig& config, Calendar& calendar, Calendar& dram_calendar)
    : config_(config),
      calendar_(calendar),
      dram_calendar_(dram_calendar),
      l2_clock_(config.l2.mhz, config.core_mhz),
      interleave_(config.l2.interleave.value),
      slice_count_(config.l2.channels * config.l2.slices_per_channel),
      slices_per_channel_(config.l2.slices_per_channel),
      slices_(slice_count_.by(), Slice(config.l2)),
      sms_(config.sm.count),
      mshrs_(kMshrBuckets, kNil) {
  for (std::uint32_t i = 0; i < config.l2.channels; ++i) {
    channels_.push_back(
        std::make_unique<DramChannel>(config.dram, config.core_mhz, dram_calendar, *this));
  }
}

// From a lookup to its answer at the SM, and to DRAM.
Cycles MemorySystem::stretch(const MachineConfig& config) {
  const Cycles least =
      config.l2.latency + std::min(config.l2.crossbar_latency, config.dram.extra_latency);
  return std::max(least, Cycles{1});
}

std::uint32_t MemorySystem::allocate() {
  ++live_;
  if (free_ == kNil) {
    requests_.push_back({});
    misses_.push_back({});
    return static_cast<std::uint32_t>(requests_.size() - 1);
  }
  const std::uint32_t index = free_;
  free_ = requests_[index].next;
  return index;
}

void MemorySystem::release(std::uint32_t index) {
  --live_;
  requests_[index].next = free_;
  free_ = index;
}

void MemorySystem::request(Cycles leaves, std::uint32_t sm, Address line, SectorMask sectors,
                           Traffic kind, bool write) {
  const auto [chunk, within] = interleave_.divide(line.value);
  const auto [row, slice_number] = slice_count_.divide(chunk);
  const std::uint64_t local = row * interleave_.by() + within;
  const auto slice = static_cast<std::uint32_t>(slice_number);
  const std::uint32_t index = allocate();
  requests_[index] = {line, local, sm, slice, kNil, kind, sectors, write};
  coming_.push_back({Address{local}, slice});
  const std::uint32_t n = sectors_in(sectors);
  SmPort& port = sms_[sm];
  const Cycles sent = port.out.take(port.calendar->now(), leaves, n);
  counts_.crossbar_sectors += write ? n : 0;
  calendar_.at(sent + config_.l2.crossbar_latency, *this, kAtSlice, index);
}

void MemorySystem::sms_done() {
  for (const Coming& c : coming_) {
    slices_[c.slice].tags.prefetch(c.local);
  }
  coming_.clear();
}

void MemorySystem::wake(Cycles now, std::uint32_t what, std::uint32_t value) {
  if (what == kAtSm) {
    deliver(now, value);
    return;
  }
  if (what == kIntoSm) {
    enter_sm(now, value);
    return;
  }
  calendar_.progress();
  if (what == kAtSlice) {
    at_slice(now, value);
    return;
  }
  const auto kind = static_cast<std::size_t>(requests_[value].kind);
  switch (what) {
    case kFill:
      fill(now, value);
      break;
    case kLookAgain:
      look_again(now, value);
      break;
    case kAtDram:
      ++counts_.dram_reads[kind];
      enqueue(now, value);
      break;
    case kWriteAtDram:
      ++counts_.dram_writes[kind];
      enqueue(now, value);
      release(value);
      break;
    default:
      A2RT_CHECK(false, "unknown appointment of the memory system");
  }
}

inline void MemorySystem::deliver(Cycles now, std::uint32_t index) {
  const Request& r = requests_[index];
  SmPort& port = sms_[r.sm];
  const Cycles first = std::max(now, port.in_free);
  port.in_free = first + Cycles{sectors_in(r.sectors)};
  if (first == now) {
    enter_sm(now, index);
  } else {
    port.calendar->at(first, *this, kIntoSm, index);
  }
}

inline void MemorySystem::enter_sm(Cycles now, std::uint32_t index) {
  const Request r = requests_[index];
  release(index);
  const SmPort& port = sms_[r.sm];
  port.calendar->progress();
  counts_.crossbar_sectors += sectors_in(r.sectors);
  port.sink->fill(now, r.line, r.sectors);
}

// L2 cycle in which the first of so many sectors is looked up; the others follow one by one.
Cycles MemorySystem::look_up(Cycles now, Slice& slice, std::uint32_t sectors) {
  const Cycles start = std::max(l2_clock_.from_core(now), slice.lookup_free);
  slice.lookup_free = start + Cycles{sectors};
  slice_busy_ += sectors;
  return start;
}

// Core cycle in which the sector at `position` of a message comes out of the slice's pipe.
Cycles MemorySystem::core_time(Cycles start, std::uint32_t position) const {
  return l2_clock_.to_core(start + Cycles{position}) + config_.l2.latency;
}

// The slice serves in order of arrival, so the outcome is known now and its time can be told.
inline void MemorySystem::at_slice(Cycles now, std::uint32_t index) {
  const Request& r = requests_[index];
  Slice& slice = slices_[r.slice];
  const std::uint32_t n = sectors_in(r.sectors);
  const Cycles start = look_up(now, slice, n);
  const auto kind = static_cast<std::size_t>(r.kind);
  if (r.write) {
    counts_.l2.writes[kind] += n;
    insert(now, r.slice, r.local, r.sectors, r.kind, true);
    release(index);
    return;
  }
  counts_.l2.reads[kind] += n;
  const SectorMask hits = slice.tags.touch(Address{r.local}, r.sectors);
  counts_.l2.hits[kind] += sectors_in(hits);
  if (hits == r.sectors && l2_clock_.same()) [[likely]] {
    respond(start + config_.l2.latency, index);  // one a cycle, as they were looked up
  } else {
    split(start, index, hits);
  }
}

// Hits go back together, none before its own time; every missing sector becomes a request of its
// own.
void MemorySystem::split(Cycles start, std::uint32_t index, SectorMask hits) {
  const Request whole = requests_[index];
  std::uint32_t position = 0, hit = 0;
  Cycles hits_ready;
  for_each_bit(whole.sectors, [&](std::uint32_t s) {
    const Cycles own = core_time(start, position++);
    if (hits >> s & 1) {
      hits_ready = std::max(hits_ready, own - Cycles{hit++});
      return;
    }
    const std::uint32_t part = allocate();
    requests_[part] = whole;
    requests_[part].sectors = static_cast<SectorMask>(1u << s);
    miss(own, part, false);
  });
  if (hits != 0) {
    requests_[index].sectors = hits;
    respond(hits_ready, index);
  } else {
    release(index);
  }
}

// Where the chain begins in which a request for this sector would be.
std::uint32_t& MemorySystem::mshrs(const Request& r) {
  const std::uint64_t sector = r.line.value / kSectorBytes + first_sector(r.sectors);
  return mshrs_[mixed(sector) >> kMshrHashShift];
}

// `waited`: a miss that had its turn in the queue for an MSHR.
void MemorySystem::miss(Cycles looked_up, std::uint32_t index, bool waited) {
  Request& r = requests_[index];
  Slice& slice = slices_[r.slice];
  misses_[index] = {looked_up, kNil};
  const auto kind = static_cast<std::size_t>(r.kind);
  std::uint32_t& head = mshrs(r);
  for (std::uint32_t i = head; i != kNil; i = requests_[i].next) {
    if (requests_[i].line == r.line && requests_[i].sectors == r.sectors) {
      ++counts_.l2.merges[kind];
      std::uint32_t tail = i;
      while (misses_[tail].merged != kNil) {
        tail = misses_[tail].merged;
      }
      misses_[tail].merged = index;
      return;
    }
  }
  if (slice.mshrs_used == config_.l2.mshrs || (!waited && slice.blocked.size > 0)) {
    counts_.l2.mshr_full += waited ? 0 : 1;
    block(slice, index, waited);
    return;
  }
  ++counts_.l2.misses[kind];
  ++slice.mshrs_used;
  r.next = head;
  head = index;
  dram_calendar_.at(looked_up + config_.dram.extra_latency, *this, kAtDram, index);
}

// A miss that had waited for an MSHR is looked up again; its sector may have come meanwhile.
void MemorySystem::look_again(Cycles now, std::uint32_t index) {
  const Request& r = requests_[index];
  Slice& slice = slices_[r.slice];
  const Cycles ready = core_time(look_up(now, slice, 1), 0);
  if (slice.tags.touch(Address{r.local}, r.sectors) != 0) {
    ++counts_.l2.hits[static_cast<std::size_t>(r.kind)];
    respond(ready, index);
  } else {
    miss(ready, index, true);
  }
  // A request that had waited for an MSHR and then needed none leaves it to the next.
  if (slice.mshrs_used < config_.l2.mshrs && slice.blocked.size > 0) {
    wake_blocked(now, slice);
  }
}

inline void MemorySystem::respond(Cycles ready, std::uint32_t index) {
  const Request& r = requests_[index];
  // The slices' time: DRAM is ahead of it, and the slices will still ask for cycles from it on.
  const Cycles sent = slices_[r.slice].out.take(calendar_.now(), ready, sectors_in(r.sectors));
  sms_[r.sm].calendar->at(sent + config_.l2.crossbar_latency, *this, kAtSm, index);
}

void MemorySystem::insert(Cycles now, std::uint32_t slice, std::uint64_t local, SectorMask sectors,
                          Traffic kind, bool dirty) {
  const auto victim = slices_[slice].tags.insert(now, Address{local}, sectors, kind, dirty);
  if (!victim) {
    return;
  }
  ++counts_.l2.evictions;
  counts_.l2.written_back += sectors_in(victim->dirty);
  for_each_bit(victim->dirty, [&](std::uint32_t s) {
    const std::uint32_t index = allocate();
    Request& r = requests_[index];
    r = {};
    r.local = victim->line * kLineBytes;
    r.sectors = static_cast<SectorMask>(1u << s);
    r.slice = slice;
    r.kind = victim->kinds[s];
    r.write = true;
    // What is thrown out leaves by the same pipe as a miss.
    dram_calendar_.at(now + config_.l2.latency + config_.dram.extra_latency, *this, kWriteAtDram,
                      index);
  });
}

// A sector goes to its channel, whose slices take turns in its memory.
void MemorySystem::enqueue(Cycles now, std::uint32_t index) {
  const Request& r = requests_[index];
  const auto [row, within] = interleave_.divide(r.local + first_sector(r.sectors) * kSectorBytes);
  const auto [channel, slice] = slices_per_channel_.divide(r.slice);
  const std::uint64_t local = (row * slices_per_channel_.by() + slice) * interleave_.by() + within;
  channels_[channel]->enqueue(now, local, r.write, index);
}

// The slice learns of the sector in its own time; those who wait for it are answered at once, as
// the SMs may run before the slice does.
void MemorySystem::dram_done(Cycles now, std::uint32_t tag) {
  const std::uint32_t first = allocate();
  requests_[first] = requests_[tag];
  respond(now, first);
  answer_merged(now, tag);
  coming_.push_back({Address{requests_[tag].local}, requests_[tag].slice});
  calendar_.at(now, *this, kFill, tag);
}

// Nobody is answered before its own lookup has come through the pipe.
void MemorySystem::answer_merged(Cycles now, std::uint32_t index) {
  std::uint32_t i = misses_[index].merged;
  misses_[index].merged = kNil;
  while (i != kNil) {
    const std::uint32_t next = misses_[i].merged;
    respond(std::max(now, misses_[i].looked_up), i);
    i = next;
  }
}

void MemorySystem::fill(Cycles now, std::uint32_t index) {
  const Request r = requests_[index];
  Slice& slice = slices_[r.slice];
  std::uint32_t* link = &mshrs(r);
  while (*link != index) {
    link = &requests_[*link].next;
  }
  *link = r.next;
  --slice.mshrs_used;
  ++counts_.l2.fills;
  if ((slice.tags.valid(Address{r.local}) & r.sectors) == 0) {
    insert(now, r.slice, r.local, r.sectors, r.kind, false);
  }
  answer_merged(now, index);
  release(index);
  if (slice.blocked.size > 0) {
    wake_blocked(now, slice);
  }
}

void MemorySystem::block(Slice& slice, std::uint32_t index, bool first) {
  Queue& queue = slice.blocked;
  requests_[index].next = first ? queue.first : kNil;
  if (queue.size++ == 0) {
    queue.first = queue.last = index;
  } else if (first) {
    queue.first = index;
  } else {
    requests_[queue.last].next = index;
    queue.last = index;
  }
}

void MemorySystem::wake_blocked(Cycles now, Slice& slice) {
  const std::uint32_t waiting = slice.blocked.first;
  slice.blocked.first = requests_[waiting].next;
  --slice.blocked.size;
  calendar_.at(now, *this, kLookAgain, waiting);
}

MemoryCounts MemorySystem::counts() const {
  MemoryCounts all = counts_;
  all.dram = dram_counts();
  return all;
}

DramCounts MemorySystem::dram_counts() const {
  DramCounts all;
  for (const auto& channel : channels_) {
    const DramCounts& c = channel->counts();
    all.reads += c.reads;
    all.writes += c.writes;
    all.row_hits += c.row_hits;
    all.row_misses += c.row_misses;
    all.row_conflicts += c.row_conflicts;
    all.activates += c.activates;
    all.busy_cycles += c.busy_cycles;
  }
  return all;
}

std::string MemorySystem::dump() const {
  std::string text = "memory: " + std::to_string(live_) + " requests between L1 and DRAM\n";
  for (std::size_t i = 0; i < slices_.size(); ++i) {
    if (slices_[i].mshrs_used > 0 || slices_[i].blocked.size > 0) {
      text += "  l2[" + std::to_string(i) + "]: " + std::to_string(slices_[i].mshrs_used) +
              " misses, " + std::to_string(slices_[i].blocked.size) + " requests blocked\n";
    }
  }
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    text += "  [" + std::to_string(i) + "] " + channels_[i]->dump();
  }
  return text;
}

void MemorySystem::check_drained() const {
  A2RT_CHECK(live_ == 0, "requests were lost below the L1s: " + dump());
  std::uint64_t misses = 0, reads = 0, answered = 0;
  for (std::size_t k = 0; k < kTrafficKinds; ++k) {
    misses += counts_.l2.misses[k];
    reads += counts_.l2.reads[k];
    answered += counts_.l2.hits[k] + counts_.l2.merges[k] + counts_.l2.misses[k];
  }
  A2RT_CHECK(reads == answered, "L2 reads differ from hits + merges + misses");
  A2RT_CHECK(misses == counts_.l2.fills && misses == dram_counts().reads,
             "L2 misses differ from fills or from DRAM reads");
  for (const auto& channel : channels_) {
    channel->check_drained();
  }
}

}  // namespace a2rt::timing
