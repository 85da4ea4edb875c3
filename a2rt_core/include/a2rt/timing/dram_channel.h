// One DRAM channel: banks with row buffers, first-ready first-come-first-served (FR-FCFS).
//
// Row hits go first, oldest first; while the data bus serves them, other banks are prepared
// (precharge, activate) for their oldest request. One row and one column command per command
// cycle. Refresh is not modelled.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/timing/calendar.h"
#include "a2rt/timing/clock.h"
#include "a2rt/timing/divider.h"
#include "a2rt/timing/machine_config.h"

namespace a2rt::timing {

struct DramCounts {
  std::uint64_t reads = 0, writes = 0;  // sectors
  std::uint64_t row_hits = 0, row_misses = 0, row_conflicts = 0;
  std::uint64_t activates = 0;
  std::uint64_t busy_cycles = 0;  // of the data bus, command clock
};

class DramChannel final : public Component {
 public:
  // Told when a read's data has arrived (core clock).
  class Client {
   public:
    virtual ~Client() = default;
    virtual void dram_done(Cycles now, std::uint32_t tag) = 0;
  };
  DramChannel(const DramConfig& config, std::uint64_t core_mhz, Calendar& calendar, Client& client);

  // `local` counts bytes within the channel. Reads are answered by Client::dram_done.
  void enqueue(Cycles now, std::uint64_t local, bool write, std::uint32_t tag);

  const DramCounts& counts() const { return counts_; }
  void wake(Cycles now, std::uint32_t what, std::uint32_t value) override;
  std::string dump() const override;
  void check_drained() const override;

 private:
  enum Wake : std::uint32_t { kSchedule, kData };
  static constexpr std::uint32_t kNil = 0xffffffffu;
  struct Request {
    std::uint64_t row = 0, order = 0;
    std::uint32_t tag = 0, bank = 0, next = kNil;
    bool write = false;
    bool needed_activate = false, needed_precharge = false;
  };
  struct Bank {
    std::uint32_t first = kNil, last = kNil;  // queued requests, oldest first
    std::uint32_t hits = 0;                   // of them, for the open row
    std::uint64_t row = 0;
    bool open = false;
    std::uint32_t place = 0;                               // in busy_
    Cycles column_ready, activate_ready, precharge_ready;  // command clock
  };
  void place(std::uint32_t index);
  void remove(std::uint32_t index, std::uint32_t before);
  void schedule(Cycles own);
  void issue_column(Cycles own);
  void prepare_row(Cycles own);
  Cycles next_chance(Cycles own) const;
  Cycles row_start(const Bank& bank) const;
  void book(Cycles own);

  DramConfig config_;
  Calendar& calendar_;
  Client& client_;
  ClockDomain clock_;
  Divider row_bytes_, bank_count_;
  std::vector<Bank> banks_;
  std::vector<std::uint32_t> busy_;  // banks that have requests, in no order
  std::vector<Request> requests_;
  std::uint32_t free_ = kNil;
  std::uint32_t waiting_first_ = kNil, waiting_last_ = kNil;  // beyond the scheduler's window
  std::uint32_t queued_ = 0, waiting_ = 0, in_flight_ = 0;
  std::uint64_t order_ = 0;
  Cycles bus_ready_, activate_ready_, row_command_ready_;
  bool last_was_write_ = false;
  bool booked_ = false;
  Cycles booked_at_;
  DramCounts counts_;
};

}  // namespace a2rt::timing
