// One streaming multiprocessor: resident warps replay their segments under greedy-then-oldest
// schedulers, load and store through the L1, and park in the RT unit while their rays are traced.
//
// A warp issues `independent_instructions` back to back, then waits for the latency of the last:
// the capture counts instructions but not their dependences. Loads are spread evenly over the
// segment's arithmetic and issued `loads_in_flight` at a time before their use; stores end the
// segment.
//
// Arithmetic concerns nobody but its scheduler: it is worked out when a warp reaches something that
// does (a load, a store, a trace, the end of its segment) or when another warp becomes ready.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "a2rt/base/inline.h"
#include "a2rt/timing/attribution.h"
#include "a2rt/timing/budget.h"
#include "a2rt/timing/calendar.h"
#include "a2rt/timing/l1_cache.h"
#include "a2rt/timing/program.h"
#include "a2rt/timing/rt_engine.h"
#include "a2rt/timing/shader_memory.h"

namespace a2rt::timing {

// What the SMs share: the warps still to be launched and the records of rays.
class SmHost {
 public:
  virtual ~SmHost() = default;
  struct NewWarp {
    WarpProgram program;
    std::uint32_t number;  // of the warp in the run
    std::uint32_t width;   // of the launch
  };
  // Fills `warp` and returns true, or returns false if no warp is left for now.
  virtual bool next_warp(NewWarp& warp) = 0;
  virtual void warp_retired(std::uint32_t sm, std::uint32_t number, Cycles residence) = 0;
  // A ray that launch id `launch` traced took so long.
  virtual void ray_time(std::uint32_t launch, Cycles cycles) = 0;
};

struct SmCounts {
  std::uint64_t warps = 0;
  std::uint64_t alu = 0, sfu = 0, uniform = 0, loads = 0, stores = 0, traces = 0;  // warp instr.
  std::array<std::uint64_t, capture::kCounters> lane_operations{};                 // lane level
  std::uint64_t lsu_sectors = 0;
  std::uint64_t warp_cycles = 0;     // residence, summed over warps
  std::uint64_t rt_warp_cycles = 0;  // of them, from trace issue to return
  std::uint64_t instructions() const { return alu + sfu + uniform + loads + stores + traces; }
};

class Sm final : public Component, public RtHost, public L1Client {
 public:
  Sm(const MachineConfig& config, std::uint32_t index, Calendar& calendar, LowerLevel& lower,
     RaySource& source, const ShaderAddresses& addresses, SmHost& host);

  // Takes a new warp if there is one and a slot is free.
  bool launch(Cycles now);
  // A slot became free: the SM takes a warp in this cycle, and must not run on before it is its
  // turn among the SMs. kNoTurn if it has nothing to ask for.
  static constexpr Cycles kNoTurn{~std::uint64_t{0}};
  Cycles turn() const { return turn_; }
  void take_turn(Cycles now);
  bool idle() const { return resident_ == 0; }
  // End of the last issue or port use booked so far, which may lie beyond the last appointment.
  Cycles booked_until() const;
  void finish(Cycles end);

  L1Cache& l1() { return l1_; }
  RtEngine& rt() { return rt_; }
  const SmCounts& counts() const { return counts_; }
  std::array<std::uint64_t, static_cast<std::size_t>(SchedulerReason::kCount)> reasons() const;
  const BinnedSeries& occupancy() const { return occupancy_; }

  void wake(Cycles now, std::uint32_t what, std::uint32_t value) override;
  void arrived(Cycles now, std::uint32_t token, SectorMask sectors,
               const SectorTimes& ready) override;
  void unblocked(Cycles now) override;
  std::string dump() const override;
  void check_drained() const override;

 private:
  enum Wake : std::uint32_t { kIssue, kLsuPort, kData, kJudge };
  static constexpr std::uint32_t kNoSlot = 0xffffffffu;
  enum class State : std::uint8_t { kEmpty, kReady, kMemory, kLsu, kRtSlot, kInRt, kCount };
  // What a scheduler looks at in every cycle, apart from the rest to stay in the host's caches.
  struct Front {
    Cycles ready;
    Cycles span;  // of its uniform and ALU instructions, from the first issue to the last result
    std::uint32_t age = 0;
    std::uint32_t uniform = 0, alu = 0, sfu = 0;  // left of the phase
    State state = State::kEmpty;
    std::uint8_t scheduler = 0;
    bool has_arithmetic() const { return (uniform | alu | sfu) != 0; }
  };
  // Kinds of loads and stores in the order in which a segment issues them.
  static constexpr std::array kAccesses = {ShaderAccess::kBufferLoad, ShaderAccess::kTexture,
                                           ShaderAccess::kPayload, ShaderAccess::kBufferStore,
                                           ShaderAccess::kPayload};
  // What every load looks at comes first.
  struct Warp {
    Cycles data;                                             // last of the loads with a time
    std::uint32_t outstanding = 0;                           // sectors loaded, of unknown arrival
    std::uint32_t loads_phase = 0, phases = 0;               // phases after this one
    std::uint32_t access = 0;                                // present one of kAccesses
    std::array<std::uint32_t, kAccesses.size()> accesses{};  // left of the segment
    LaneAddresses addresses;
    // What is left of the segment after this phase.
    std::uint32_t alu = 0, sfu = 0, loads = 0, stores = 0;
    Cycles launched, traced;
    std::uint32_t number = 0;
    bool judging = false;
    LaneRays rays{};
    WarpProgram program;
    std::vector<CandidateJob> jobs;
  };
  struct Scheduler {
    std::uint32_t last = kNoSlot;  // issued last
    Cycles free, sfu_free;
    bool booked = false;
    Cycles booked_at;
    std::array<std::uint32_t, static_cast<std::size_t>(State::kCount)> states{};
    std::vector<std::uint32_t> ready;  // slots, in no order
    Attribution<SchedulerReason> attribution;
  };
  struct LsuEntry {
    std::uint64_t line;
    std::uint32_t slot;
    SectorMask sectors;
    bool write;
  };
  // sm.cpp: warps, and what they wait for
  A2RT_NOINLINE void begin_judging(Cycles now, std::uint32_t slot);
  void set_state(Cycles now, std::uint32_t slot, State state);
  void make_ready(Cycles now, std::uint32_t slot, Cycles ready);
  SchedulerReason idle_reason(const Scheduler& scheduler) const;
  void account(Cycles now, Scheduler& scheduler);
  void account_occupancy(Cycles now);
  void retire(Cycles now, std::uint32_t slot);
  void enter_rt(Cycles now, std::uint32_t slot);

  // sm_segment.cpp: what a warp's segment costs
  void begin_work(std::uint32_t slot, const SegmentWork& work);
  void begin_phase(std::uint32_t slot);
  Cycles bursts_span(std::uint32_t instructions, Cycles latency) const;
  bool end_segment(Cycles now, std::uint32_t slot, Scheduler& scheduler);

  // sm_issue.cpp: schedulers and what they issue
  void issue(Cycles now, std::uint32_t scheduler);
  void advance(Cycles end, std::uint32_t scheduler);
  void book(Cycles now, std::uint32_t scheduler);
  Cycles earliest_end(const Scheduler& scheduler, const Front& front) const;
  std::uint32_t choose(const Scheduler& scheduler) const;
  A2RT_INLINE void spend(Cycles begin, Cycles end, Scheduler& scheduler, std::uint32_t issued,
                         SchedulerReason reason);
  // These return whether anything was issued.
  A2RT_INLINE bool step(Cycles now, std::uint32_t slot, Scheduler& scheduler);
  A2RT_INLINE bool issue_access(Cycles now, std::uint32_t slot, Scheduler& scheduler, bool write);
  bool issue_arithmetic(Cycles at, Cycles end, Front& front, Scheduler& scheduler);
  std::uint32_t issue_bursts(Cycles at, Cycles end, std::uint32_t& left, Cycles latency,
                             Front& front, Scheduler& scheduler);
  A2RT_INLINE void queue_lines(Cycles now, std::uint32_t slot, std::uint32_t ordinal, bool write);

  // sm_lsu.cpp: the load/store unit
  A2RT_INLINE void kick_lsu(Cycles now) {
    if (!lsu_booked_ && !lsu_blocked_ && lsu_head_ != lsu_.size()) {
      lsu_booked_ = true;
      calendar_.at(lsu_port_.next(now), *this, kLsuPort);
    }
  }
  void run_lsu(Cycles now);
  A2RT_INLINE void access_ahead(Cycles now, Warp& warp, std::uint32_t ordinal, bool write);
  bool lsu_full_ahead(Cycles now);
  A2RT_INLINE void send(Cycles now, LsuEntry& entry);
  A2RT_INLINE void add_data(Cycles now, std::uint32_t slot, SectorMask sectors,
                            const SectorTimes& ready);
  // When all of a waiting warp's loads have a time, it is ready at the last.
  A2RT_INLINE void data_known(Cycles now, std::uint32_t slot, const Warp& warp) {
    if (warp.outstanding == 0 && fronts_[slot].state == State::kMemory) {
      calendar_.at(std::max(now, warp.data), *this, kData, slot);
    }
  }
  void wake_lsu_waiters(Cycles now);

  void rays_done(Cycles now, std::uint32_t warp, Cycles ready) override;
  void slot_free(Cycles now) override;
  void judge(Cycles start, std::uint32_t warp, const std::vector<CandidateJob>& jobs) override;
  void ray_time(std::uint32_t warp, std::uint32_t lane, Cycles cycles) override {
    host_.ray_time(warps_[warp].program.launch(lane), cycles);
  }

  MachineConfig config_;
  std::uint32_t index_;
  Calendar& calendar_;
  const ShaderAddresses& addresses_;
  SmHost& host_;
  L1Cache l1_;
  RtEngine rt_;
  std::vector<Front> fronts_;  // by slot, like warps_
  std::vector<Warp> warps_;
  std::vector<Scheduler> schedulers_;
  std::vector<std::uint32_t> waiting_for_rt_;  // slots, in order of arrival
  std::vector<LsuEntry> lsu_;
  std::size_t lsu_head_ = 0;
  std::uint32_t lsu_sectors_ = 0;  // queued
  std::uint32_t lsu_waiters_ = 0;  // warps that wait for room in the queue
  bool lsu_booked_ = false, lsu_blocked_ = false;
  Port lsu_port_;
  bool reserves_;  // model "reserved"
  SmHost::NewWarp new_warp_{};
  std::deque<Cycles> turns_;  // in order
  Cycles turn_ = kNoTurn;     // first of them
  std::uint32_t resident_ = 0;
  std::uint32_t age_ = 0;
  SmCounts counts_;
  BinnedSeries occupancy_;
  Cycles occupancy_until_;
};

}  // namespace a2rt::timing
