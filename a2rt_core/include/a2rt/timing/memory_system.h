// Everything below the L1s: crossbar, L2 slices, DRAM channels.
//
// The crossbar moves one sector per cycle into and out of every SM and every slice. A slice starts
// one sector's lookup per L2 cycle; a hit answers `latency` later, a miss reaches its DRAM channel
// `extra_latency` after that. Lookups and what enters an SM are first come first served, so their
// queues are no more than the cycle from which they are free; what leaves an SM or a slice is known
// ahead of time, and what is ready first goes first. L2 writes back and allocates on write without
// fetching (stores and spills are whole sectors).
//
// Time is run in stretches: first the DRAM channels, then the SMs, then the slices. What goes from
// one to the next takes at least stretch() cycles, or has been decided in an earlier stretch.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "a2rt/timing/calendar.h"
#include "a2rt/timing/clock.h"
#include "a2rt/timing/dram_channel.h"
#include "a2rt/timing/memory_port.h"
#include "a2rt/timing/reserved_port.h"
#include "a2rt/timing/tag_store.h"

namespace a2rt::timing {

class MemorySystem final : public Component, public LowerLevel, public DramChannel::Client {
 public:
  // The slices run by `calendar`, the DRAM channels by `dram_calendar`; they may be the same.
  MemorySystem(const MachineConfig& config, Calendar& calendar, Calendar& dram_calendar);
  // Cycles for which DRAM, then the SMs, then the slices can each run alone.
  static Cycles stretch(const MachineConfig& config);
  // `calendar` is the SM's; it may be ahead of the slices' by stretch().
  void connect(std::uint32_t sm, LineSink& sink, Calendar& calendar) {
    sinks_.at(sm) = &sink;
    sm_calendars_.at(sm) = &calendar;
  }

  void request(Cycles leaves, std::uint32_t sm, Address line, SectorMask sectors, Traffic kind,
               bool write) override;

  // The slices run next: brings the tags of what they will look up and fill into the host's caches,
  // all at once. Changes nothing.
  void prefetch_slices();

  const CacheCounts& l2_counts() const { return l2_counts_; }
  const TrafficCounts& dram_reads() const { return dram_reads_; }
  const TrafficCounts& dram_writes() const { return dram_writes_; }
  DramCounts dram_counts() const;
  std::uint64_t crossbar_sectors() const { return crossbar_sectors_; }
  std::uint64_t slice_busy_cycles() const { return slice_busy_; }
  std::uint32_t slice_count() const { return static_cast<std::uint32_t>(slices_.size()); }

  void wake(Cycles now, std::uint32_t what, std::uint32_t value) override;
  std::string dump() const override;
  void check_drained() const override;

 private:
  enum Wake : std::uint32_t { kAtSlice, kLookAgain, kAtDram, kWriteAtDram, kFill, kAtSm, kIntoSm };
  static constexpr std::uint32_t kNil = 0xffffffffu;
  // Sectors of one line on their way, in consecutive cycles; below the L2's lookup, misses go one
  // by one.
  struct Request {
    Address line;
    std::uint64_t local = 0;  // of the line, within the slice; of the sector, once missed
    std::uint32_t sm = 0, slice = 0, next = kNil;
    Traffic kind = Traffic::kNone;
    SectorMask sectors = 0;
    bool write = false;
    Cycles looked_up;  // end of its way through the L2's pipe
  };
  struct Slice {
    TagStore tags;
    Cycles lookup_free;                // L2 clock
    ReservedPort out;                  // core clock
    std::vector<std::uint32_t> mshrs;  // hash buckets of request indices, chained by `next`
    std::uint32_t mshrs_used = 0;
    std::deque<std::uint32_t> blocked;  // oldest first; who comes later waits behind them
  };
  // A lookup or a fill that the slices will come to in their next stretch.
  struct Coming {
    Address local;
    std::uint32_t slice;
  };
  std::uint32_t allocate();
  void release(std::uint32_t index);
  void at_slice(Cycles now, std::uint32_t index);
  Cycles look_up(Cycles now, Slice& slice, std::uint32_t sectors);
  Cycles core_time(Cycles start, std::uint32_t position) const;
  void split(Cycles start, std::uint32_t index, SectorMask hits);
  void look_again(Cycles now, std::uint32_t index);
  void miss(Cycles looked_up, std::uint32_t index, bool waited);
  void wake_blocked(Cycles now, Slice& slice);
  void fill(Cycles now, std::uint32_t index);
  void answer_merged(Cycles now, std::uint32_t index);
  void deliver(Cycles now, std::uint32_t index);
  void enter_sm(Cycles now, std::uint32_t index);
  void respond(Cycles ready, std::uint32_t index);
  void insert(Cycles now, std::uint32_t slice, std::uint64_t local, SectorMask sectors,
              Traffic kind, bool dirty);
  std::uint64_t channel_local(std::uint32_t slice, std::uint64_t local) const;
  void dram_done(Cycles now, std::uint32_t tag) override;
  std::size_t bucket(std::uint64_t local) const {
    return ((local / kSectorBytes) * 0x9e3779b97f4a7c15u) >> 56;
  }

  MachineConfig config_;
  Calendar& calendar_;
  Calendar& dram_calendar_;
  ClockDomain l2_clock_;
  std::vector<Slice> slices_;
  std::vector<std::unique_ptr<DramChannel>> channels_;
  std::vector<LineSink*> sinks_;
  std::vector<Calendar*> sm_calendars_;
  std::vector<ReservedPort> sm_out_;
  std::vector<Cycles> sm_in_free_;
  std::vector<Request> requests_;
  // Who waits for a sector that is on its way, chained behind the request that fetches it.
  std::vector<std::uint32_t> merged_;
  std::uint32_t free_ = kNil;
  std::uint64_t live_ = 0;
  std::vector<Coming> coming_;
  CacheCounts l2_counts_;
  TrafficCounts dram_reads_{}, dram_writes_{};
  std::uint64_t crossbar_sectors_ = 0;
  std::uint64_t slice_busy_ = 0;
};

}  // namespace a2rt::timing
