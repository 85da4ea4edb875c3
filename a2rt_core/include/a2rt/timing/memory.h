// Everything below the L1s, as the machine sees it, in one of two models.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "a2rt/timing/calendar.h"
#include "a2rt/timing/dram_channel.h"
#include "a2rt/timing/memory_port.h"

namespace a2rt::timing {

struct MemoryCounts {
  CacheCounts l2;
  DramCounts dram;
  TrafficCounts dram_reads{}, dram_writes{};
  std::uint64_t crossbar_sectors = 0;
};

class Memory : public LowerLevel {
 public:
  // Cycles for which the parts of the machine can each run alone, one after another.
  static Cycles stretch(const MachineConfig& config);
  // `sink` is the L1 of SM `sm`, which runs by `calendar`.
  virtual void connect(std::uint32_t sm, LineSink& sink, Calendar& calendar) = 0;
  // A stretch of time begins at `now`: nothing asks for an earlier cycle any more.
  virtual void begin_stretch(Cycles now) = 0;
  // The SMs have run to the end of the stretch; what is below them runs next.
  virtual void sms_done() = 0;
  virtual MemoryCounts counts() const = 0;
  virtual std::string dump() const = 0;
  // Throws InternalError if anything is under way or the counts contradict each other.
  virtual void check_drained() const = 0;
};

// The slices run by `calendar`, the DRAM channels by `dram_calendar`, if the model has use for
// them.
std::unique_ptr<Memory> make_memory(const MachineConfig& config, Calendar& calendar,
                                    Calendar& dram_calendar);

}  // namespace a2rt::timing
