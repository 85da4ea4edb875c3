// Everything below the L1s in the model "queued": crossbar, L2 slices, DRAM channels.
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
#include <memory>
#include <string>
#include <vector>

#include "a2rt/timing/clock.h"
#include "a2rt/timing/divider.h"
#include "a2rt/timing/memory.h"
#include "a2rt/timing/reserved_port.h"
#include "a2rt/timing/tag_store.h"

namespace a2rt::timing {

class MemorySystem final : public Component, public Memory, public DramChannel::Client {
 public:
  // The slices run by `calendar`, the DRAM channels by `dram_calendar`; they may be the same.
  MemorySystem(const MachineConfig& config, Calendar& calendar, Calendar& dram_calendar);
  // Cycles for which DRAM, then the SMs, then the slices can each run alone.
  static Cycles stretch(const MachineConfig& config);
  // `calendar` is the SM's; it may be ahead of the slices' by stretch().
  void connect(std::uint32_t sm, LineSink& sink, Calendar& calendar) override {
    sms_.at(sm).sink = &sink;
    sms_.at(sm).calendar = &calendar;
  }

  void request(Cycles leaves, std::uint32_t sm, Address line, SectorMask sectors, Traffic kind,
               bool write) override;

  void begin_stretch(Cycles) override {}
  // Brings the tags of what the slices will look up and fill into the host's caches, all at once.
  // Changes nothing.
  void sms_done() override;

  MemoryCounts counts() const override;
  std::uint64_t slice_busy_cycles() const { return slice_busy_; }
  std::uint32_t slice_count() const { return static_cast<std::uint32_t>(slices_.size()); }

  void wake(Cycles now, std::uint32_t what, std::uint32_t value) override;
  std::string dump() const override;
  void check_drained() const override;

 private:
  enum Wake : std::uint32_t { kAtSlice, kLookAgain, kAtDram, kWriteAtDram, kFill, kAtSm, kIntoSm };
  static constexpr std::uint32_t kNil = 0xffffffffu;
  // Sectors of one line on their way, in consecutive cycles; below the L2's lookup, misses go one
  // by one. Half a line of the host.
  struct Request {
    Address line;
    std::uint64_t local = 0;  // of the line, within the slice
    std::uint32_t sm = 0, slice = 0, next = kNil;
    Traffic kind = Traffic::kNone;
    SectorMask sectors = 0;
    bool write = false;
  };
  // What only a request that missed has.
  struct Miss {
    Cycles looked_up;             // end of its way through the L2's pipe
    std::uint32_t merged = kNil;  // who waits for the same sector, chained
  };
  // Requests chained by `next`, oldest first.
  struct Queue {
    std::uint32_t first = kNil, last = kNil, size = 0;
  };
  struct Slice {
    explicit Slice(const L2Config& config) : tags(config.slice_capacity, config.ways, "l2") {}
    Cycles lookup_free;  // L2 clock
    ReservedPort out;    // core clock
    std::uint32_t mshrs_used = 0;
    Queue blocked;  // who comes later waits behind them
    TagStore tags;
  };
  // The crossbar's end at an SM.
  struct SmPort {
    LineSink* sink = nullptr;
    Calendar* calendar = nullptr;
    Cycles in_free;
    ReservedPort out;
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
  std::uint32_t& mshrs(const Request& r);
  void look_again(Cycles now, std::uint32_t index);
  void miss(Cycles looked_up, std::uint32_t index, bool waited);
  void block(Slice& slice, std::uint32_t index, bool first);
  void wake_blocked(Cycles now, Slice& slice);
  void fill(Cycles now, std::uint32_t index);
  void answer_merged(Cycles now, std::uint32_t index);
  void deliver(Cycles now, std::uint32_t index);
  void enter_sm(Cycles now, std::uint32_t index);
  void respond(Cycles ready, std::uint32_t index);
  void insert(Cycles now, std::uint32_t slice, std::uint64_t local, SectorMask sectors,
              Traffic kind, bool dirty);
  void enqueue(Cycles now, std::uint32_t index);
  void dram_done(Cycles now, std::uint32_t tag) override;
  DramCounts dram_counts() const;

  MachineConfig config_;
  Calendar& calendar_;
  Calendar& dram_calendar_;
  ClockDomain l2_clock_;
  Divider interleave_, slice_count_, slices_per_channel_;
  std::vector<Slice> slices_;
  std::vector<std::unique_ptr<DramChannel>> channels_;
  std::vector<SmPort> sms_;
  std::vector<Request> requests_;
  std::vector<Miss> misses_;          // by request
  std::vector<std::uint32_t> mshrs_;  // hash buckets of misses, chained by `next`
  std::uint32_t free_ = kNil;
  std::uint64_t live_ = 0;
  std::vector<Coming> coming_;
  MemoryCounts counts_;  // but for the channels'
  std::uint64_t slice_busy_ = 0;
};

}  // namespace a2rt::timing
