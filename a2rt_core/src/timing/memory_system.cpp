#include "a2rt/timing/memory_system.h"

#include <algorithm>

namespace a2rt::timing {

MemorySystem::MemorySystem(const MachineConfig& config, Calendar& calendar)
    : config_(config),
      calendar_(calendar),
      l2_clock_(config.l2.mhz, config.core_mhz),
      sinks_(config.sm.count),
      sm_calendars_(config.sm.count),
      sm_out_free_(config.sm.count),
      sm_in_free_(config.sm.count) {
  const std::uint32_t slices = config.l2.channels * config.l2.slices_per_channel;
  for (std::uint32_t i = 0; i < slices; ++i) {
    slices_.push_back({TagStore(config.l2.slice_capacity, config.l2.ways, "l2"),
                       {},
                       {},
                       std::vector<std::uint32_t>(256, kNil),
                       0,
                       {}});
  }
  for (std::uint32_t i = 0; i < config.l2.channels; ++i) {
    channels_.push_back(
        std::make_unique<DramChannel>(config.dram, config.core_mhz, calendar, *this));
  }
}

std::uint32_t MemorySystem::allocate() {
  ++live_;
  if (free_ == kNil) {
    requests_.push_back({});
    merged_.push_back(kNil);
    return static_cast<std::uint32_t>(requests_.size() - 1);
  }
  const std::uint32_t index = free_;
  free_ = requests_[index].next;
  merged_[index] = kNil;
  return index;
}

void MemorySystem::release(std::uint32_t index) {
  --live_;
  requests_[index].next = free_;
  free_ = index;
}

void MemorySystem::request(Cycles leaves, std::uint32_t sm, Address sector, Traffic kind,
                           bool write) {
  const std::uint64_t step = config_.l2.interleave.value;
  const std::uint64_t chunk = sector.value / step;
  const std::uint32_t index = allocate();
  Request& r = requests_[index];
  r = {sector, chunk / slices_.size() * step + sector.value % step,
       sm,     static_cast<std::uint32_t>(chunk % slices_.size()),
       kNil,   kind,
       write,  false,
       false};
  const Cycles sent = std::max(leaves, sm_out_free_[sm]);
  sm_out_free_[sm] = sent + Cycles{1};
  crossbar_sectors_ += write;
  calendar_.at(sent + config_.l2.crossbar_latency, *this, kAtSlice, index);
}

void MemorySystem::wake(Cycles now, std::uint32_t what, std::uint32_t value) {
  if (what == kAtSm) {
    deliver(now, value);
    return;
  }
  calendar_.progress();
  Request& r = requests_[value];
  switch (what) {
    case kAtSlice: {
      Slice& slice = slices_[r.slice];
      const Cycles start = std::max(l2_clock_.from_core(now), slice.lookup_free);
      slice.lookup_free = start + Cycles{1};
      ++slice_busy_;
      const Cycles core = l2_clock_.to_core(start);
      if (core > now) {
        calendar_.at(core, *this, kLookup, value);
      } else {
        lookup(now, value);
      }
      break;
    }
    case kLookup: {
      Slice& slice = slices_[r.slice];
      lookup(now, value);
      // A request that had waited for an MSHR and then needed none leaves it to the next.
      if (slice.mshrs_used < config_.l2.mshrs && !slice.blocked.empty()) {
        wake_blocked(now, slice);
      }
      break;
    }
    case kAtDram:
      ++dram_reads_[static_cast<std::size_t>(r.kind)];
      channels_[r.slice / config_.l2.slices_per_channel]->enqueue(
          now, channel_local(r.slice, r.local), false, value);
      break;
    case kWriteAtDram:
      ++dram_writes_[static_cast<std::size_t>(r.kind)];
      channels_[r.slice / config_.l2.slices_per_channel]->enqueue(
          now, channel_local(r.slice, r.local), true, value);
      release(value);
      break;
    default:
      A2RT_CHECK(false, "unknown appointment of the memory system");
  }
}

void MemorySystem::deliver(Cycles now, std::uint32_t index) {
  Request& r = requests_[index];
  Cycles& port = sm_in_free_[r.sm];
  Calendar& calendar = *sm_calendars_[r.sm];
  calendar.progress();
  if (!r.refill && now < port) {
    r.refill = true;  // comes again in the cycle kept free for it
    calendar.at(port, *this, kAtSm, index);
    port += Cycles{1};
    return;
  }
  if (!r.refill) {
    port = now + Cycles{1};
  }
  const std::uint32_t sm = r.sm;
  const Address sector = r.sector;
  release(index);
  ++crossbar_sectors_;
  sinks_[sm]->fill(now, sector);
}

void MemorySystem::lookup(Cycles now, std::uint32_t index) {
  Request& r = requests_[index];
  Slice& slice = slices_[r.slice];
  const auto kind = static_cast<std::size_t>(r.kind);
  if (r.write) {
    ++l2_counts_.writes[kind];
    insert(now, slice, r.slice, r.local, r.kind, true);
    release(index);
    return;
  }
  if (!r.waited_for_mshr) {
    ++l2_counts_.reads[kind];
  }
  if (slice.tags.touch(Address{r.local})) {
    ++l2_counts_.hits[kind];
    respond(now + config_.l2.latency, index);
    return;
  }
  miss(now, index);
}

void MemorySystem::miss(Cycles now, std::uint32_t index) {
  Request& r = requests_[index];
  Slice& slice = slices_[r.slice];
  const auto kind = static_cast<std::size_t>(r.kind);
  std::uint32_t& head = slice.mshrs[bucket(r.local)];
  for (std::uint32_t i = head; i != kNil; i = requests_[i].next) {
    if (requests_[i].local == r.local) {
      ++l2_counts_.merges[kind];
      std::uint32_t tail = i;
      while (merged_[tail] != kNil) {
        tail = merged_[tail];
      }
      merged_[tail] = index;
      return;
    }
  }
  if (slice.mshrs_used == config_.l2.mshrs) {
    ++l2_counts_.mshr_full;
    r.waited_for_mshr = true;
    slice.blocked.push_back(index);
    return;
  }
  ++l2_counts_.misses[kind];
  ++slice.mshrs_used;
  r.next = head;
  head = index;
  calendar_.at(now + config_.l2.latency + config_.dram.extra_latency, *this, kAtDram, index);
}

void MemorySystem::respond(Cycles ready, std::uint32_t index) {
  Slice& slice = slices_[requests_[index].slice];
  const Cycles sent = std::max(ready, slice.out_free);
  slice.out_free = sent + Cycles{1};
  sm_calendars_[requests_[index].sm]->at(sent + config_.l2.crossbar_latency, *this, kAtSm, index);
}

void MemorySystem::insert(Cycles now, Slice& slice, std::uint32_t slice_index, std::uint64_t local,
                          Traffic kind, bool dirty) {
  const auto victim = slice.tags.insert(now, Address{local}, kind, dirty);
  if (!victim) {
    return;
  }
  ++l2_counts_.evictions;
  for (std::uint32_t s = 0; s < kSectorsPerLine; ++s) {
    if (victim->dirty >> s & 1) {
      ++l2_counts_.written_back;
      const std::uint32_t index = allocate();
      Request& r = requests_[index];
      r = {};
      r.local = victim->line * kLineBytes + s * kSectorBytes;
      r.slice = slice_index;
      r.kind = victim->kinds[s];
      r.write = true;
      calendar_.at(now + config_.dram.extra_latency, *this, kWriteAtDram, index);
    }
  }
}

std::uint64_t MemorySystem::channel_local(std::uint32_t slice, std::uint64_t local) const {
  const std::uint64_t step = config_.l2.interleave.value;
  const std::uint32_t per_channel = config_.l2.slices_per_channel;
  return (local / step * per_channel + slice % per_channel) * step + local % step;
}

void MemorySystem::dram_done(Cycles now, std::uint32_t tag) {
  const std::uint32_t slice_index = requests_[tag].slice;
  Slice& slice = slices_[slice_index];
  const std::uint64_t local = requests_[tag].local;
  std::uint32_t* link = &slice.mshrs[bucket(local)];
  while (*link != tag) {
    link = &requests_[*link].next;
  }
  *link = requests_[tag].next;
  --slice.mshrs_used;
  ++l2_counts_.fills;
  if (!slice.tags.contains(Address{local})) {
    insert(now, slice, slice_index, local, requests_[tag].kind, false);
  }
  for (std::uint32_t i = tag; i != kNil;) {
    const std::uint32_t next = merged_[i];
    respond(now, i);
    i = next;
  }
  if (!slice.blocked.empty()) {
    wake_blocked(now, slice);
  }
}

void MemorySystem::wake_blocked(Cycles now, Slice& slice) {
  const std::uint32_t waiting = slice.blocked.front();
  slice.blocked.pop_front();
  calendar_.at(now, *this, kLookup, waiting);
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
    if (slices_[i].mshrs_used > 0 || !slices_[i].blocked.empty()) {
      text += "  l2[" + std::to_string(i) + "]: " + std::to_string(slices_[i].mshrs_used) +
              " misses, " + std::to_string(slices_[i].blocked.size()) + " requests blocked\n";
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
    misses += l2_counts_.misses[k];
    reads += l2_counts_.reads[k];
    answered += l2_counts_.hits[k] + l2_counts_.merges[k] + l2_counts_.misses[k];
  }
  A2RT_CHECK(reads == answered, "L2 reads differ from hits + merges + misses");
  A2RT_CHECK(misses == l2_counts_.fills && misses == dram_counts().reads,
             "L2 misses differ from fills or from DRAM reads");
  for (const auto& channel : channels_) {
    channel->check_drained();
  }
}

}  // namespace a2rt::timing
