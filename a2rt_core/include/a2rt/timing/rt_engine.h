// The RT unit of one SM in time: warp buffer, per-ray state machines, short stacks, finite testers,
// one port to the L1.
//
// It replays the events of each ray. A fetch waits for all its sectors; a test waits for its
// tester; stack and context entries beyond what is kept on chip cost stores and loads; a candidate
// for an any-hit or intersection shader leaves for the SM and comes back.
//
// Whatever a lane does alone is worked out as soon as its start is known: when the last sector is
// found in L1, the tests on it are reserved at once and the lane has one appointment, at its next
// fetch. The port sends what is queued for the next few cycles in one appointment; in the model
// "reserved" there is no queue, and a lane's lines are sent as it asks for them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/base/inline.h"
#include "a2rt/timing/attribution.h"
#include "a2rt/timing/budget.h"
#include "a2rt/timing/calendar.h"
#include "a2rt/timing/compiled_rays.h"
#include "a2rt/timing/l1_cache.h"
#include "a2rt/timing/lane_ops.h"
#include "a2rt/timing/machine_config.h"
#include "a2rt/timing/ray_source.h"
#include "a2rt/timing/request_table.h"
#include "a2rt/timing/tester_pool.h"
#include "a2rt/workload/workload.h"

namespace a2rt::timing {

inline constexpr std::uint32_t kLanes = 32;
using LaneRays = std::array<std::uint32_t, kLanes>;  // ray index or kNone per lane

// A candidate that a lane wants judged.
struct CandidateJob {
  std::uint32_t lane = 0;
  std::uint32_t ordinal = 0;
  bool intersection = false;
};

// What the SM does for its RT unit.
class RtHost {
 public:
  virtual ~RtHost() = default;
  // All rays of the warp are done; `ready` is when it can issue again.
  virtual void rays_done(Cycles now, std::uint32_t warp, Cycles ready) = 0;
  // A place in the warp buffer became free.
  virtual void slot_free(Cycles now) = 0;
  // Run the shaders for these candidates at `start` and answer with RtEngine::candidates_done.
  virtual void judge(Cycles start, std::uint32_t warp, const std::vector<CandidateJob>& jobs) = 0;
  // The lane's ray took `cycles` from its start in the unit to its end.
  virtual void ray_time(std::uint32_t warp, std::uint32_t lane, Cycles cycles) = 0;
};

// What the rays wanted, and what came of it in time.
struct RtCounts : LaneOpCounts {
  std::uint64_t rays = 0, warps = 0;
  std::uint64_t sectors_sent = 0, stores_sent = 0, port_cycles = 0;
  std::uint64_t round_trips = 0, candidates = 0;
  std::array<std::uint64_t, static_cast<std::size_t>(LaneReason::kCount)> lane_cycles{};
  std::uint64_t warp_cycles = 0;  // residence, summed over warps
};

class RtEngine final : public Component, public L1Client {
 public:
  RtEngine(const MachineConfig& config, std::uint32_t index, Calendar& calendar, L1Cache& l1,
           RaySource& source, RtHost& host);

  bool has_room() const { return resident_ < slots_.size(); }
  // Takes a warp; throws InternalError if there is no room. `rays` is a copy: rays without events
  // end at once, upon which the warp goes on to its next ones.
  void accept(Cycles now, std::uint32_t warp, LaneRays rays);
  void candidates_done(Cycles now, std::uint32_t warp);

  void finish(Cycles end);  // closes the books
  const RtCounts& counts() const { return counts_; }
  const Attribution<RtReason>& attribution() const { return attribution_; }
  const TesterPool& pool(Tester t) const { return pools_[static_cast<std::size_t>(t)]; }
  const BinnedSeries& occupancy() const { return occupancy_; }
  const BinnedSeries& active_lanes() const { return active_series_; }
  const BinnedSeries& port_use() const { return port_series_; }

  // The unit will run alone for some time; the books hold only so many cycles that are not closed.
  void begin_stretch(Cycles now) {
    if (reserves_) {
      account_cycles(now);
    }
  }
  void wake(Cycles now, std::uint32_t what, std::uint32_t value) override;
  void arrived(Cycles now, std::uint32_t token, SectorMask sectors,
               const SectorTimes& ready) override;
  void unblocked(Cycles now) override;
  std::string dump() const override;
  void check_drained() const override;

 private:
  enum Wake : std::uint32_t { kLane, kNearLanes, kPort, kLaneAhead };
  // kInUnit: waits for lines, is in a tester, or its next cycle is known.
  enum class LaneState : std::uint8_t { kNone, kInUnit, kCandidate, kAtShader, kDone };
  struct Lane {
    const LaneOp* op = nullptr;  // next
    Cycles ready, started;
    std::uint16_t missing = 0;  // lines
    std::uint16_t ordinal = 0;
    LaneState state = LaneState::kNone;
    bool intersection = false;
  };
  static constexpr std::uint32_t kNear = 64;
  static constexpr std::ptrdiff_t kOpsPerHostLine = 64 / sizeof(LaneOp);
  struct Slot {
    std::uint32_t index = 0;  // in slots_
    std::uint32_t rank = 0;   // by age among the resident warps
    bool used = false, judging = false;
    std::uint32_t warp = 0;
    std::uint32_t active = 0;     // lanes not done
    std::uint32_t suspended = 0;  // lanes with a candidate, not yet sent
    std::uint32_t away = 0;       // lanes whose candidate is on the SM
    Cycles arrived;
    RequestTable requests;
    // Lanes that go on in the same near cycle share an appointment: bit per lane, by cycle.
    std::array<std::uint32_t, kNear> wake_at{};
    std::array<Lane, kLanes> lanes;
    LaneOps ops;  // of all lanes, one after another
    std::vector<CandidateJob> jobs;
  };
  // Fetches and compiles the rays of a new warp.
  void compile(Cycles now, Slot& slot, const LaneRays& rays);
  void prefetch_ray(std::uint32_t ray) const;
  const LaneOp* compile_ray(std::uint32_t ray, Address spill, LaneOps& ops);
  void compile_events(std::uint32_t ray, Address spill, LaneOps& ops);
  // The lane goes on in cycle `at`, which may be later than `now`.
  void run_lane(Cycles now, Cycles at, Slot& slot, std::uint32_t lane);
  Cycles run_tests(Cycles now, Cycles at, Lane& lane);
  Cycles issue(Cycles now, Cycles at, Tester tester, std::uint32_t count);
  [[noreturn]] void fail_without(Tester tester) const;
  void appoint(Cycles now, Cycles at, Slot& slot, std::uint32_t lane);
  // Asks for the lines of a read, of which `op` is the first. The lane waits for those of unknown
  // arrival, or goes on when the others are there.
  void read(Cycles now, Slot& slot, std::uint32_t lane, LaneOp op);
  // Model "reserved" (rt_engine_reserved.cpp): the same, but all lines get their times at once, and
  // so do the tests on them.
  void go_on_ahead(Cycles now, Slot& slot, std::uint32_t lane);
  void read_ahead(Cycles now, Slot& slot, std::uint32_t lane, LaneOp op);
  Cycles fetch_line(Cycles now, const Slot& slot, LaneOp op);
  void store_ahead(Cycles now, LaneOp op);
  void prefetch_line(LaneOp op) const;
  void book_port(Cycles now);
  Port::Sent send_ahead(Cycles now, std::uint32_t sectors);
  void suspend(Cycles now, Slot& slot, std::uint32_t lane, LaneOp op);
  void maybe_judge(Cycles now, Slot& slot);
  void back_from_shader(Cycles now, Slot& slot, std::uint32_t lane);
  void end_ray(Cycles now, Slot& slot, std::uint32_t lane);
  void end_warp(Cycles now, Slot& slot);
  void set_state(Cycles now, Lane& lane, LaneState state);
  // A stay adds its end and subtracts its beginning, so nobody has to remember when it began.
  void begin(LaneReason reason, Cycles at) { lane_cycles(reason) -= at.value; }
  void end(LaneReason reason, Cycles at) { lane_cycles(reason) += at.value; }
  std::uint64_t& lane_cycles(LaneReason reason) {
    return counts_.lane_cycles[static_cast<std::size_t>(reason)];
  }
  void proceed(Cycles now, Cycles at, Slot& slot, std::uint32_t lane);
  A2RT_NOINLINE void settle(Cycles now, Slot& slot, std::uint32_t token, SectorMask sectors,
                            const SectorTimes& ready);
  void kick_port(Cycles now);
  void run_port(Cycles now);
  void update_asking(const Slot& slot) {
    asking_ &= ~(std::uint64_t{1} << slot.rank);
    asking_ |= std::uint64_t{!slot.requests.nothing_to_send()} << slot.rank;
  }
  void forget_rank(std::uint32_t rank);
  Address spill_memory(const Slot& slot, std::uint32_t lane) const;
  void send_store(Cycles now);
  void send_request(Cycles now, Slot& slot);
  RtReason reason() const;
  void account(Cycles now);
  void account_cycles(Cycles now);

  MachineConfig config_;
  std::uint32_t index_;
  Calendar& calendar_;
  L1Cache& l1_;
  RaySource& source_;
  RtHost& host_;
  std::array<TesterPool, kTesters> pools_;
  std::vector<Slot> slots_;
  std::vector<Slot*> by_age_;  // resident warps', oldest first
  std::uint64_t asking_ = 0;   // bit per rank: has requests for the port
  std::uint32_t resident_ = 0;
  struct Store {
    std::uint64_t line;
    SectorMask sector;
    Traffic kind;
  };
  std::vector<Store> stores_;  // sent in order
  std::size_t stores_head_ = 0;
  Port port_;
  bool port_booked_ = false, port_blocked_ = false;
  bool reserves_;                              // model "reserved"
  std::uint32_t in_unit_ = 0, in_shader_ = 0;  // lanes
  LaneCompiler compiler_;
  CompiledRays* compiled_;  // rays kept from one run to the next, or nullptr
  RtCounts counts_;
  Attribution<RtReason> attribution_;
  BusyCycles testing_;
  BusyCycles sending_;  // this and the next only in the model "reserved"
  std::uint64_t port_cycles_booked_ = 0;
  BinnedSeries occupancy_, active_series_, port_series_;
  Cycles series_until_;
};

}  // namespace a2rt::timing
