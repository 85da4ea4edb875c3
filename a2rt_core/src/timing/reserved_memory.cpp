#include "a2rt/timing/reserved_memory.h"

#include <algorithm>
#include <utility>

namespace a2rt::timing {
namespace {

constexpr std::size_t kLinesFromDram = 2048;

}  // namespace

ReservedMemory::ReservedMemory(const MachineConfig& config)
    : config_(config),
      l2_clock_(config.l2.mhz, config.core_mhz),
      dram_clock_(config.dram.mhz, config.core_mhz),
      interleave_(config.l2.interleave.value),
      slice_count_(config.l2.channels * config.l2.slices_per_channel),
      slices_per_channel_(config.l2.slices_per_channel),
      row_bytes_(config.dram.row.value),
      bank_count_(config.dram.banks),
      burst_(std::max(config.dram.burst, config.dram.ccd).value),
      turnaround_((config.dram.turnaround.value + burst_.by() - 1) / burst_.by()),
      slices_(slice_count_.by(), Slice(config.l2)),
      sms_(config.sm.count),
      channels_(config.l2.channels),
      coming_(kLinesFromDram) {
  for (Channel& channel : channels_) {
    channel.banks.resize(config.dram.banks);
  }
}

inline ReservedMemory::Place ReservedMemory::place(Address line) const {
  const auto [chunk, within] = interleave_.divide(line.value);
  const auto [row, slice] = slice_count_.divide(chunk);
  return {row * interleave_.by() + within, static_cast<std::uint32_t>(slice)};
}

// Core cycle in which the first sector comes out of the slice's pipe.
inline Cycles ReservedMemory::look_up(Cycles sent, Slice& slice, std::uint32_t sectors) {
  const Cycles at = sent + config_.l2.crossbar_latency;
  const Cycles start =
      slice.lookup.take(l2_clock_.from_core(now_), l2_clock_.from_core(at), sectors);
  return l2_clock_.to_core(start) + config_.l2.latency;
}

Cycles ReservedMemory::read(Cycles leaves, std::uint32_t sm, Address line, SectorMask sectors,
                            Traffic kind) {
  const Place place = this->place(line);
  const std::uint32_t n = sectors_in(sectors);
  const auto k = static_cast<std::size_t>(kind);
  SmPort& port = sms_[sm];
  Slice& slice = slices_[place.slice];
  const Cycles looked_up = look_up(port.out.take(now_, leaves, n), slice, n);
  const SectorMask present = slice.tags.touch(Address{place.local}, sectors);
  const ComingLines::Line* coming = coming_.find(line_of(line));
  const SectorMask merged = coming == nullptr ? SectorMask{0} : coming->coming(looked_up, present);
  counts_.l2.reads[k] += n;
  counts_.l2.merges[k] += sectors_in(merged);
  counts_.l2.hits[k] += sectors_in(present) - sectors_in(merged);
  Cycles ready = looked_up;
  if (merged != 0) {
    ready = coming->there();
  }
  if (present != sectors) {
    const auto missing = static_cast<SectorMask>(sectors & ~present);
    const Cycles there = miss(looked_up, place, missing, kind);
    coming_.obtain(looked_up, line_of(line)).add(looked_up, missing, there);
    ready = std::max(ready, there);
  }
  counts_.crossbar_sectors += n;
  const Cycles sent = slice.out.take(now_, ready, n);
  return port.in.take(now_, sent + config_.l2.crossbar_latency, n);
}

// Returns when all of the sectors have come from DRAM.
Cycles ReservedMemory::miss(Cycles looked_up, const Place& place, SectorMask sectors,
                            Traffic kind) {
  const std::uint32_t n = sectors_in(sectors);
  if (n > config_.l2.mshrs) [[unlikely]] {
    Cycles last;
    for_each_bit(sectors, [&](std::uint32_t s) {
      last = std::max(last, miss(looked_up, place, static_cast<SectorMask>(1u << s), kind));
    });
    return last;
  }
  const auto k = static_cast<std::size_t>(kind);
  counts_.l2.misses[k] += n;
  counts_.l2.fills += n;
  counts_.dram_reads[k] += n;
  counts_.dram.reads += n;
  InFlight& mshrs = slices_[place.slice].mshrs;
  const Cycles leaves = mshrs.begin(looked_up, n);
  counts_.l2.mshr_full += leaves > looked_up;
  const Cycles there = at_dram(leaves + config_.dram.extra_latency, place, n, false);
  mshrs.add(n, there);
  insert(looked_up, place, sectors, kind, false);
  return there;
}

void ReservedMemory::request(Cycles leaves, std::uint32_t sm, Address line, SectorMask sectors,
                             Traffic kind, bool write) {
  A2RT_CHECK(write, "a read that is answered at once was asked for as one that is not");
  const Place place = this->place(line);
  const std::uint32_t n = sectors_in(sectors);
  counts_.l2.writes[static_cast<std::size_t>(kind)] += n;
  counts_.crossbar_sectors += n;
  const Cycles sent = sms_[sm].out.take(now_, leaves, n);
  insert(look_up(sent, slices_[place.slice], n), place, sectors, kind, true);
}

void ReservedMemory::insert(Cycles now, const Place& place, SectorMask sectors, Traffic kind,
                            bool dirty) {
  const auto victim =
      slices_[place.slice].tags.insert(now, Address{place.local}, sectors, kind, dirty);
  if (!victim) {
    return;
  }
  ++counts_.l2.evictions;
  if (victim->dirty == 0) {
    return;
  }
  const std::uint32_t n = sectors_in(victim->dirty);
  counts_.l2.written_back += n;
  counts_.dram.writes += n;
  for_each_bit(victim->dirty, [&](std::uint32_t s) {
    ++counts_.dram_writes[static_cast<std::size_t>(victim->kinds[s])];
  });
  at_dram(now + config_.l2.latency + config_.dram.extra_latency,
          {victim->line * kLineBytes, place.slice}, n, true);
}

// A channel's slices take turns in its memory. Returns when the last sector has gone over the bus.
Cycles ReservedMemory::at_dram(Cycles at, const Place& place, std::uint32_t sectors, bool write) {
  const auto [chunk, within] = interleave_.divide(place.local);
  const auto [channel_number, slice] = slices_per_channel_.divide(place.slice);
  const std::uint64_t local =
      (chunk * slices_per_channel_.by() + slice) * interleave_.by() + within;
  Channel& channel = channels_[channel_number];
  const auto [row, bank] = bank_count_.divide(row_bytes_.quotient(local));
  const Cycles data = open_row(dram_clock_.from_core(at), channel.banks[bank], row, sectors, write);
  counts_.dram.row_hits += sectors - 1;
  counts_.dram.busy_cycles += sectors * config_.dram.burst.value;
  const Cycles past{dram_clock_.from_core(now_).value / burst_.by()};
  Cycles start{(data.value + burst_.by() - 1) / burst_.by()};
  // Every other change of direction: a scheduler that may choose makes fewer of them.
  if (!std::exchange(channel.last_was_write, write) && write) {
    for (std::uint64_t left = turnaround_; left > 0; left -= std::min<std::uint64_t>(left, 4)) {
      const auto part = static_cast<std::uint32_t>(std::min<std::uint64_t>(left, 4));
      start = channel.bus.take(past, start, part) + Cycles{part};
    }
  }
  const Cycles sent = channel.bus.take(past, start, sectors);
  return dram_clock_.to_core(Cycles{(sent.value + sectors) * burst_.by()});
}

// Command cycle of the first data. Who comes before what the bank was last asked for waits for no
// more than its own commands, and leaves no trace. Of what a precharge waits for, only what has
// been written counts: a scheduler that serves row hits first hides the rest, and this is none.
Cycles ReservedMemory::open_row(Cycles own, Bank& bank, std::uint64_t row, std::uint32_t sectors,
                                bool write) {
  const DramConfig& d = config_.dram;
  const bool hit = bank.open && bank.row == row, in_order = own >= bank.asked;
  ++(hit         ? counts_.dram.row_hits
     : bank.open ? counts_.dram.row_conflicts
                 : counts_.dram.row_misses);
  counts_.dram.activates += !hit;
  const Cycles to_data = write ? d.wl : d.cl;
  Cycles column = own;
  if (hit) {
    column = in_order ? std::max(own, bank.column_ready) : own;
  } else {
    const Cycles precharge = in_order ? std::max(own, bank.written) : own;
    Cycles activate = bank.open ? precharge + d.rp : own;
    activate = in_order ? std::max(activate, bank.activate_ready) : activate;
    column = activate + d.rcd;
    if (in_order) {
      bank = {row, true, own, activate + d.rc, column, Cycles{0}};
    }
  }
  if (in_order) {
    bank.asked = own;
    bank.written = write ? column + to_data + d.burst * sectors + d.wr : bank.written;
  }
  return column + to_data;
}

std::string ReservedMemory::dump() const {
  return "memory: reserved ahead, nothing is under way\n";
}

void ReservedMemory::check_drained() const {
  for (std::size_t k = 0; k < kTrafficKinds; ++k) {
    const CacheCounts& l2 = counts_.l2;
    A2RT_CHECK(l2.reads[k] == l2.hits[k] + l2.merges[k] + l2.misses[k],
               "L2 reads differ from hits + merges + misses");
    A2RT_CHECK(l2.misses[k] == counts_.dram_reads[k], "L2 misses differ from DRAM reads");
  }
  const DramCounts& dram = counts_.dram;
  A2RT_CHECK(dram.row_hits + dram.row_misses + dram.row_conflicts == dram.reads + dram.writes,
             "a DRAM access neither hit nor missed its row");
}

}  // namespace a2rt::timing
