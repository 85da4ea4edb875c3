// The L1 data cache of one SM, shared by its load/store unit and its RT unit, which both see its
// latency, banks and MSHRs.
//
// A read is looked up when it is accepted and answered `latency` later; a miss leaves for L2 after
// the same latency (the lookup is at the end of the pipe, as in GPGPU-Sim). Lines are allocated
// when their data comes. Shader stores write through without allocating; spilled stacks and
// contexts, private to a thread, are kept and written back when evicted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/timing/budget.h"
#include "a2rt/timing/calendar.h"
#include "a2rt/timing/machine_config.h"
#include "a2rt/timing/memory_port.h"
#include "a2rt/timing/tag_store.h"

namespace a2rt::timing {

// Appointments that the L1 makes for its clients.
enum L1Wake : std::uint32_t {
  kL1Data = 0,      // value = token of the read
  kL1Unblocked = 1  // an MSHR was freed after a read had been turned away
};

class L1Cache final : public SectorSink {
 public:
  L1Cache(const L1Config& config, Calendar& calendar, LowerLevel& lower, std::uint32_t sm);

  enum class Reply : std::uint8_t { kAccepted, kBankBusy, kMshrFull };
  // On kAccepted the client is woken once with (kL1Data, token). On kMshrFull it is woken with
  // kL1Unblocked when trying again makes sense; on kBankBusy it tries again next cycle.
  Reply read(Cycles now, Address sector, Traffic kind, Component& client, std::uint32_t token);
  Reply write(Cycles now, Address sector, Traffic kind);

  void fill(Cycles now, Address sector) override;

  const CacheCounts& counts() const { return counts_; }
  const TagStore& tags() const { return tags_; }
  std::uint32_t misses_in_flight() const { return mshrs_used_; }
  std::string dump() const;
  void check_drained() const;

 private:
  static constexpr std::uint32_t kNil = 0xffffffffu;
  struct Waiter {
    Component* client;
    std::uint32_t token;
    std::uint32_t next;
    Cycles earliest;
  };
  struct Mshr {
    Address sector;
    std::uint32_t first = kNil, last = kNil, next = kNil;
    std::uint32_t merged = 0;
    Traffic kind = Traffic::kNone;
  };
  std::size_t bucket(Address sector) const {
    return ((sector.value / kSectorBytes) * 0x9e3779b97f4a7c15u) >> 54;
  }
  // Banks are a power of two on every machine we know; others pay for a division.
  Budget& bank_of(Address sector) {
    const std::uint64_t index = sector.value / kSectorBytes;
    return banks_[bank_mask_ != 0 ? index & bank_mask_ : index % banks_.size()];
  }
  std::uint32_t find_mshr(Address sector) const;
  void add_waiter(Mshr& mshr, Component& client, std::uint32_t token, Cycles earliest);
  void wait_for_mshr(Component& client);
  void insert(Cycles now, Address sector, Traffic kind, bool dirty);

  L1Config config_;
  Calendar& calendar_;
  LowerLevel& lower_;
  std::uint32_t sm_;
  TagStore tags_;
  std::vector<Budget> banks_;
  std::uint64_t bank_mask_ = 0;
  std::vector<Mshr> mshrs_;
  std::vector<std::uint32_t> buckets_;
  std::uint32_t free_mshr_ = kNil;
  std::uint32_t mshrs_used_ = 0;
  std::vector<Waiter> waiters_;
  std::uint32_t free_waiter_ = kNil;
  std::uint32_t waiters_used_ = 0;
  std::vector<Component*> turned_away_;
  CacheCounts counts_;
};

}  // namespace a2rt::timing
