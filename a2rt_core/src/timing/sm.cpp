// Warps and schedulers of an SM; what a warp does in its segment is in sm_segment.cpp.
#include "a2rt/timing/sm.h"

#include <algorithm>
#include <limits>

namespace a2rt::timing {
namespace {

constexpr std::uint32_t kNoSlot = 0xffffffffu;
constexpr Cycles kNever{std::numeric_limits<std::uint64_t>::max()};

}  // namespace

Sm::Sm(const MachineConfig& config, std::uint32_t index, Calendar& calendar, LowerLevel& lower,
       RaySource& source, const ShaderAddresses& addresses, SmHost& host)
    : config_(config),
      index_(index),
      calendar_(calendar),
      addresses_(addresses),
      host_(host),
      l1_(config.l1, calendar, lower, index),
      rt_(config, index, calendar, l1_, source, *this),
      warps_(config.sm.warps),
      schedulers_(config.sm.schedulers),
      lsu_budget_(config.sm.lsu_sectors_per_cycle) {
  for (std::uint32_t slot = 0; slot < config.sm.warps; ++slot) {
    ++schedulers_[slot % schedulers_.size()].states[static_cast<std::size_t>(State::kEmpty)];
  }
}

bool Sm::launch(Cycles now) {
  const auto free = std::find_if(warps_.begin(), warps_.end(),
                                 [](const Warp& w) { return w.state == State::kEmpty; });
  if (free == warps_.end() || !host_.next_warp(new_warp_)) {
    return false;
  }
  account_occupancy(now);
  const auto slot = static_cast<std::uint32_t>(free - warps_.begin());
  Warp& warp = *free;
  warp.program = new_warp_.program;
  warp.number = new_warp_.number;
  warp.width = new_warp_.width;
  warp.judging = false;
  warp.launched = now;
  warp.age = age_++;
  warp.outstanding = 0;
  ++resident_;
  ++counts_.warps;
  if (!warp.program.next(warp.work, warp.rays)) {
    set_state(now, slot, State::kReady);
    retire(now, slot);
    return true;
  }
  begin_work(warp);
  make_ready(now, slot, now);
  return true;
}

void Sm::retire(Cycles now, std::uint32_t slot) {
  account_occupancy(now);
  Warp& warp = warps_[slot];
  set_state(now, slot, State::kEmpty);
  --resident_;
  counts_.warp_cycles += now.value - warp.launched.value;
  host_.warp_retired(index_, warp.number, now - warp.launched);
  calendar_.at(now + Cycles{1}, *this, kResume);
}

void Sm::set_state(Cycles now, std::uint32_t slot, State state) {
  Scheduler& scheduler = schedulers_[slot % schedulers_.size()];
  account(now, scheduler);
  --scheduler.states[static_cast<std::size_t>(warps_[slot].state)];
  ++scheduler.states[static_cast<std::size_t>(state)];
  warps_[slot].state = state;
}

void Sm::make_ready(Cycles now, std::uint32_t slot, Cycles ready) {
  set_state(now, slot, State::kReady);
  warps_[slot].ready = ready;
  book(now, slot % static_cast<std::uint32_t>(schedulers_.size()));
}

// Books the scheduler for the first cycle in which some warp of its can issue.
void Sm::book(Cycles now, std::uint32_t index) {
  Scheduler& scheduler = schedulers_[index];
  Cycles earliest = kNever;
  for (std::uint32_t slot = index; slot < warps_.size();
       slot += static_cast<std::uint32_t>(schedulers_.size())) {
    if (warps_[slot].state == State::kReady) {
      earliest = std::min(earliest, warps_[slot].ready);
    }
  }
  if (earliest == kNever) {
    return;
  }
  const Cycles when = std::max({now, earliest, scheduler.free});
  if (scheduler.booked && scheduler.booked_at <= when) {
    return;
  }
  scheduler.booked = true;
  scheduler.booked_at = when;
  calendar_.at(when, *this, kIssue, index);
}

// Greedy then oldest: the warp that issued last if it can, else the oldest that can.
std::uint32_t Sm::choose(Cycles now, const Scheduler& scheduler, std::uint32_t index) const {
  const auto can = [&](const Warp& w) { return w.state == State::kReady && w.ready <= now; };
  if (scheduler.last % schedulers_.size() == index && can(warps_[scheduler.last])) {
    return scheduler.last;
  }
  std::uint32_t best = kNoSlot;
  for (std::uint32_t slot = index; slot < warps_.size();
       slot += static_cast<std::uint32_t>(schedulers_.size())) {
    if (can(warps_[slot]) && (best == kNoSlot || warps_[slot].age < warps_[best].age)) {
      best = slot;
    }
  }
  return best;
}

void Sm::issue(Cycles now, std::uint32_t index) {
  Scheduler& scheduler = schedulers_[index];
  if (!scheduler.booked || scheduler.booked_at != now) {
    return;  // an earlier booking replaced this one
  }
  scheduler.booked = false;
  while (true) {
    const std::uint32_t slot = choose(now, scheduler, index);
    if (slot == kNoSlot) {
      break;
    }
    if (step(now, slot, index) == Issue::kIssued) {
      scheduler.last = slot;
      calendar_.progress();
      break;
    }
  }
  book(now, index);
}

void Sm::wake(Cycles now, std::uint32_t what, std::uint32_t value) {
  switch (what) {
    case kL1Data: {
      calendar_.progress();
      Warp& warp = warps_[value];
      A2RT_CHECK(warp.outstanding > 0, "load data came for a warp that loads nothing");
      if (--warp.outstanding == 0 && warp.state == State::kMemory) {
        make_ready(now, value, now);
      }
      return;
    }
    case kL1Unblocked:
      lsu_blocked_ = false;
      kick_lsu(now);
      return;
    case kIssue:
      issue(now, value);
      return;
    case kLsuPort:
      run_lsu(now);
      return;
    case kJudge: {
      Warp& warp = warps_[value];
      warp.judging = true;
      A2RT_CHECK(warp.program.next_judgement(warp.jobs, warp.work), "no candidate to judge");
      begin_work(warp);
      make_ready(now, value, now);
      return;
    }
    case kResume:
      launch(now);
      return;
    default:
      A2RT_CHECK(false, "unknown appointment of the SM");
  }
}

void Sm::rays_done(Cycles now, std::uint32_t slot, Cycles ready) {
  Warp& warp = warps_[slot];
  counts_.rt_warp_cycles += ready.value - warp.traced.value;
  if (!warp.program.next(warp.work, warp.rays)) {
    // Nothing follows: the warp ends with its rays.
    warp.work = {};
    warp.rays.fill(kNone);
  }
  begin_work(warp);
  make_ready(now, slot, ready);
}

void Sm::slot_free(Cycles now) {
  if (!waiting_for_rt_.empty() && rt_.has_room()) {
    const std::uint32_t slot = waiting_for_rt_.front();
    waiting_for_rt_.erase(waiting_for_rt_.begin());
    enter_rt(now, slot);
  }
}

void Sm::judge(Cycles start, std::uint32_t slot, const std::vector<CandidateJob>& jobs) {
  warps_[slot].jobs = jobs;
  calendar_.at(start, *this, kJudge, slot);
}

SchedulerReason Sm::idle_reason(const Scheduler& scheduler) const {
  static constexpr std::pair<State, SchedulerReason> kOrder[] = {
      {State::kReady, SchedulerReason::kWaitDependency},
      {State::kMemory, SchedulerReason::kWaitMemory},
      {State::kLsu, SchedulerReason::kWaitLsu},
      {State::kRtSlot, SchedulerReason::kWaitRtSlot},
      {State::kInRt, SchedulerReason::kWaitRtUnit}};
  for (const auto& [state, reason] : kOrder) {
    if (scheduler.states[static_cast<std::size_t>(state)] > 0) {
      return reason;
    }
  }
  return SchedulerReason::kNoWarp;
}

void Sm::account(Cycles now, Scheduler& scheduler) {
  if (now > scheduler.attribution.booked()) {
    scheduler.attribution.until(now, idle_reason(scheduler));
  }
}

void Sm::account_occupancy(Cycles now) {
  if (now > occupancy_until_) {
    occupancy_.add(occupancy_until_, now, resident_);
    occupancy_until_ = now;
  }
}

Cycles Sm::booked_until() const {
  Cycles until = rt_.attribution().booked();
  for (const Scheduler& scheduler : schedulers_) {
    until = std::max(until, scheduler.attribution.booked());
  }
  return until;
}

void Sm::finish(Cycles end) {
  account_occupancy(end);
  for (Scheduler& scheduler : schedulers_) {
    account(end, scheduler);
    scheduler.attribution.check(end);
  }
  rt_.finish(end);
}

std::array<std::uint64_t, static_cast<std::size_t>(SchedulerReason::kCount)> Sm::reasons() const {
  std::array<std::uint64_t, static_cast<std::size_t>(SchedulerReason::kCount)> all{};
  for (const Scheduler& scheduler : schedulers_) {
    for (std::size_t r = 0; r < all.size(); ++r) {
      all[r] += scheduler.attribution.cycles()[r];
    }
  }
  return all;
}

std::string Sm::dump() const {
  static constexpr const char* kStates[] = {"empty",
                                            "ready",
                                            "waits for loads",
                                            "waits for the load/store queue",
                                            "waits for the RT unit",
                                            "in the RT unit"};
  std::string text = "sm[" + std::to_string(index_) + "]: " + std::to_string(resident_) +
                     " warps, load/store queue " + std::to_string(lsu_.size() - lsu_head_) +
                     (lsu_blocked_ ? " blocked by MSHRs" : "") + "\n";
  for (std::size_t slot = 0; slot < warps_.size(); ++slot) {
    if (warps_[slot].state != State::kEmpty) {
      text += "  slot " + std::to_string(slot) + " warp " + std::to_string(warps_[slot].number) +
              ": " + kStates[static_cast<std::size_t>(warps_[slot].state)] +
              (warps_[slot].judging ? ", judging candidates" : "") + ", " +
              std::to_string(warps_[slot].outstanding) + " sectors outstanding\n";
    }
  }
  return text + rt_.dump() + l1_.dump();
}

void Sm::check_drained() const {
  A2RT_CHECK(resident_ == 0 && lsu_head_ == lsu_.size() && waiting_for_rt_.empty(),
             "an SM is not empty: " + dump());
  rt_.check_drained();
  l1_.check_drained();
}

}  // namespace a2rt::timing
