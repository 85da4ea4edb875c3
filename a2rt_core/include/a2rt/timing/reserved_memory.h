// Everything below the L1s in the model "reserved": a read reserves its way through crossbar, L2
// slice and DRAM channel when it is asked for, and its answer's cycle is known at once.
//
// Ports, lookups, links and data buses are as wide as in the model "queued" and are reserved in any
// order, so what is ready first goes first. Tags, rows and MSHRs are taken in the order in which
// reads are asked for, which within a stretch is SM by SM; DRAM serves first come first served.
// What is on its way comes when it was asked for, also for an SM that would have asked earlier.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/timing/clock.h"
#include "a2rt/timing/coming_lines.h"
#include "a2rt/timing/divider.h"
#include "a2rt/timing/in_flight.h"
#include "a2rt/timing/memory.h"
#include "a2rt/timing/reserved_port.h"
#include "a2rt/timing/tag_store.h"

namespace a2rt::timing {

class ReservedMemory final : public Memory {
 public:
  explicit ReservedMemory(const MachineConfig& config);
  // No message limits it. The longer, the less often an SM's state comes back to the host's caches,
  // and the more often SMs reserve what is shared in another order than that of time.
  static constexpr Cycles kStretch{512};

  bool answers_at_once() const override { return true; }
  Cycles read(Cycles leaves, std::uint32_t sm, Address line, SectorMask sectors,
              Traffic kind) override;
  // Writes only.
  void request(Cycles leaves, std::uint32_t sm, Address line, SectorMask sectors, Traffic kind,
               bool write) override;

  void connect(std::uint32_t, LineSink&, Calendar&) override {}
  void begin_stretch(Cycles now) override { now_ = now; }
  void sms_done() override {}
  MemoryCounts counts() const override { return counts_; }
  std::string dump() const override;
  void check_drained() const override;

 private:
  struct Slice {
    explicit Slice(const L2Config& config)
        : mshrs(config.mshrs), tags(config.slice_capacity, config.ways, "l2") {}
    ReservedPort lookup;  // L2 clock
    ReservedPort out;     // core clock
    InFlight mshrs;
    TagStore tags;
  };
  struct SmPort {
    ReservedPort in, out;
  };
  struct Bank {
    std::uint64_t row = 0;
    bool open = false;
    Cycles asked, activate_ready, column_ready, written;  // command clock
  };
  struct Channel {
    ReservedPort bus;  // cycles of a sector's burst each
    bool last_was_write = false;
    std::vector<Bank> banks;
  };
  struct Place {
    std::uint64_t local;  // of the line, within the slice
    std::uint32_t slice;
  };
  Place place(Address line) const;
  Cycles look_up(Cycles sent, Slice& slice, std::uint32_t sectors);
  Cycles miss(Cycles looked_up, const Place& place, SectorMask sectors, Traffic kind);
  Cycles at_dram(Cycles at, const Place& place, std::uint32_t sectors, bool write);
  Cycles open_row(Cycles own, Bank& bank, std::uint64_t row, std::uint32_t sectors, bool write);
  void insert(Cycles now, const Place& place, SectorMask sectors, Traffic kind, bool dirty);

  MachineConfig config_;
  ClockDomain l2_clock_, dram_clock_;
  Divider interleave_, slice_count_, slices_per_channel_, row_bytes_, bank_count_, burst_;
  std::uint64_t turnaround_;  // in bursts
  std::vector<Slice> slices_;
  std::vector<SmPort> sms_;
  std::vector<Channel> channels_;
  ComingLines coming_;
  Cycles now_;
  MemoryCounts counts_;
};

}  // namespace a2rt::timing
