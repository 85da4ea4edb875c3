// Schedulers of an SM: which warp issues when, and what that brings about.
#include <algorithm>

#include "a2rt/timing/sm.h"

namespace a2rt::timing {
// Cycle before which the warp cannot be through with its phase's arithmetic.
Cycles Sm::earliest_end(const Scheduler& scheduler, const Front& front) const {
  const Cycles at = std::max(front.ready, scheduler.free) + front.span;
  if (front.sfu == 0) {
    return at;
  }
  const SmConfig& sm = config_.sm;
  return std::max(at, scheduler.sfu_free) + sm.sfu_interval * (front.sfu - 1) + sm.sfu_latency;
}

// Books the scheduler for the first cycle in which a warp may reach something beyond arithmetic.
void Sm::book(Cycles now, std::uint32_t index) {
  Scheduler& scheduler = schedulers_[index];
  Cycles earliest = Calendar::kNever;
  for (const std::uint32_t slot : scheduler.ready) {
    earliest = std::min(earliest, earliest_end(scheduler, fronts_[slot]));
  }
  if (earliest == Calendar::kNever) {
    return;
  }
  const Cycles when = std::max(now, earliest);
  if (scheduler.booked && scheduler.booked_at <= when) {
    return;
  }
  scheduler.booked = true;
  scheduler.booked_at = when;
  calendar_.at(when, *this, kIssue, index);
}

// Which of the ready warps issues next. Greedy then oldest: of those that can issue first the one
// that issued last, else the oldest.
std::uint32_t Sm::choose(const Scheduler& scheduler) const {
  std::uint32_t best = kNoSlot;
  Cycles first = Calendar::kNever;
  std::uint64_t first_rank = 0;
  for (const std::uint32_t slot : scheduler.ready) {
    const Front& front = fronts_[slot];
    const Cycles at = std::max(front.ready, scheduler.free);
    const std::uint64_t rank = slot == scheduler.last ? 0 : std::uint64_t{front.age} + 1;
    if (at < first || (at == first && rank < first_rank)) {
      best = slot;
      first = at;
      first_rank = rank;
    }
  }
  return best;
}

// Issues `issued` instructions in the cycles from `begin` to `end`. The warp is ready, so in the
// others its scheduler waited for results.
void Sm::spend(Cycles begin, Cycles end, Scheduler& scheduler, std::uint32_t issued,
               SchedulerReason reason) {
  A2RT_CHECK(begin >= scheduler.free, "a scheduler issued twice in one cycle");
  scheduler.free = end;
  scheduler.attribution.until(end, issued, reason, SchedulerReason::kWaitDependency);
}

// Issues arithmetic from cycle `at` on, as far as nothing else can be issued before `end`.
bool Sm::issue_arithmetic(Cycles at, Cycles end, Front& front, Scheduler& scheduler) {
  const SmConfig& sm = config_.sm;
  if (front.uniform > 0) {
    counts_.uniform += issue_bursts(at, end, front.uniform, sm.uniform_latency, front, scheduler);
    return true;
  }
  if (front.alu > 0) {
    counts_.alu += issue_bursts(at, end, front.alu, sm.alu_latency, front, scheduler);
    return true;
  }
  if (scheduler.sfu_free > at) {
    front.ready = scheduler.sfu_free;
    return false;
  }
  --front.sfu;
  ++counts_.sfu;
  spend(at, at + Cycles{1}, scheduler, 1, SchedulerReason::kIssueSfu);
  scheduler.sfu_free = at + sm.sfu_interval;
  front.ready = at + (front.sfu > 0 ? sm.sfu_interval : sm.sfu_latency);
  return true;
}

// Issues the bursts of one kind of instruction that begin before `end`: each when the one before
// has its results. Returns how many instructions that are.
std::uint32_t Sm::issue_bursts(Cycles at, Cycles end, std::uint32_t& left, Cycles latency,
                               Front& front, Scheduler& scheduler) {
  const std::uint32_t burst = config_.sm.independent_instructions;
  const Cycles period = Cycles{burst - 1} + latency;
  Cycles last = at;
  std::uint32_t whole = 0;  // bursts before the last
  if (left > burst && at + period < end) {
    const std::uint64_t fit = (end.value - at.value - 1) / period.value;
    whole = static_cast<std::uint32_t>(std::min<std::uint64_t>(fit, (left - 1) / burst));
    last += period * whole;
  }
  const std::uint32_t in_last = std::min(left - whole * burst, burst);
  const std::uint32_t issued = whole * burst + in_last;
  left -= issued;
  spend(at, last + Cycles{in_last}, scheduler, issued, SchedulerReason::kIssueAlu);
  front.ready = last + Cycles{in_last - 1} + latency;
  front.span = front.span - (front.ready - at);
  return issued;
}

// Puts an access into the load/store unit's queue: one entry per line.
void Sm::queue_lines(Cycles now, std::uint32_t slot, std::uint32_t ordinal, bool write) {
  Warp& warp = warps_[slot];
  if (reserves_) {
    access_ahead(now, warp, ordinal, write);
    return;
  }
  std::uint32_t count = 0;
  addresses_.lines(
      kAccesses[warp.access], ordinal,
      warp.addresses, [&](std::uint64_t line, SectorMask sectors) __attribute__((always_inline)) {
        lsu_.push_back({line, slot, sectors, write});
        count += sectors_in(sectors);
      });
  warp.outstanding += write ? 0 : count;
  lsu_sectors_ += count;
  counts_.lsu_sectors += count;
  kick_lsu(now);
}

bool Sm::issue_access(Cycles now, std::uint32_t slot, Scheduler& scheduler, bool write) {
  Warp& warp = warps_[slot];
  Front& front = fronts_[slot];
  if (reserves_ ? lsu_full_ahead(now) : lsu_sectors_ >= config_.sm.lsu_queue) {
    set_state(now, slot, State::kLsu);
    return false;
  }
  while (warp.accesses[warp.access] == 0) {
    ++warp.access;
  }
  const std::uint32_t ordinal = --warp.accesses[warp.access];
  --(write ? warp.stores : warp.loads_phase);
  ++(write ? counts_.stores : counts_.loads);
  spend(now, now + Cycles{1}, scheduler, 1, SchedulerReason::kIssueMemory);
  front.ready = now + Cycles{1};
  const bool last_load = !write && warp.loads_phase == 0;
  if (config_.shader_memory == ShaderMemory::kIdeal) {
    front.ready = last_load ? now + config_.l1.latency : front.ready;
    return true;
  }
  queue_lines(now, slot, ordinal, write);
  if (last_load && (warp.outstanding > 0 || warp.data > front.ready)) {
    set_state(now, slot, State::kMemory);
    data_known(now, slot, warp);
  }
  return true;
}

// What a warp does in cycle `now` once its phase's arithmetic is done.
bool Sm::step(Cycles now, std::uint32_t slot, Scheduler& scheduler) {
  A2RT_CHECK(now == calendar_.now(), "a warp left its arithmetic in the past");
  const Warp& warp = warps_[slot];
  if (warp.loads_phase > 0) {
    return issue_access(now, slot, scheduler, false);
  }
  if (warp.phases > 0) {
    begin_phase(slot);
    return false;
  }
  if (warp.stores > 0) {
    return issue_access(now, slot, scheduler, true);
  }
  return end_segment(now, slot, scheduler);
}

// Makes all issue decisions of the cycles before `end`. Before the present cycle there can be
// nothing but arithmetic, or the scheduler would have been booked for it.
void Sm::advance(Cycles end, std::uint32_t index) {
  Scheduler& scheduler = schedulers_[index];
  while (!scheduler.ready.empty()) {
    // A warp alone goes on by itself.
    const bool alone = scheduler.ready.size() == 1;
    const std::uint32_t slot = alone ? scheduler.ready.front() : choose(scheduler);
    Front& front = fronts_[slot];
    const Cycles at = std::max(front.ready, scheduler.free);
    if (at >= end) {
      return;
    }
    const bool issued = front.has_arithmetic()
                            ? issue_arithmetic(at, alone ? end : at + Cycles{1}, front, scheduler)
                            : step(at, slot, scheduler);
    if (issued) {
      scheduler.last = slot;
      calendar_.progress();
    }
  }
}

void Sm::issue(Cycles now, std::uint32_t index) {
  Scheduler& scheduler = schedulers_[index];
  if (!scheduler.booked || scheduler.booked_at != now) {
    return;  // an earlier booking replaced this one
  }
  scheduler.booked = false;
  advance(now + Cycles{1}, index);
  book(now, index);
}

}  // namespace a2rt::timing
