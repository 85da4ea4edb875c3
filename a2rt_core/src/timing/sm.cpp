// Warps of an SM and what they wait for; its schedulers are in sm_issue.cpp.
#include "a2rt/timing/sm.h"

#include <algorithm>

namespace a2rt::timing {

Sm::Sm(const MachineConfig& config, std::uint32_t index, Calendar& calendar, LowerLevel& lower,
       RaySource& source, const ShaderAddresses& addresses, SmHost& host)
    : config_(config),
      index_(index),
      calendar_(calendar),
      addresses_(addresses),
      host_(host),
      l1_(config.l1, lower, index),
      rt_(config, index, calendar, l1_, source, *this),
      fronts_(config.sm.warps),
      warps_(config.sm.warps),
      schedulers_(config.sm.schedulers),
      lsu_port_(config.sm.lsu_sectors_per_cycle),
      reserves_(config.model == Model::kReserved) {
  A2RT_CHECK(config.sm.schedulers < 256, "an SM has fewer than 256 schedulers");
  for (std::uint32_t slot = 0; slot < config.sm.warps; ++slot) {
    const std::size_t scheduler = slot % schedulers_.size();
    fronts_[slot].scheduler = static_cast<std::uint8_t>(scheduler);
    ++schedulers_[scheduler].states[static_cast<std::size_t>(State::kEmpty)];
    warps_[slot].addresses.thread_block = index * config.sm.warps + slot;
  }
}

bool Sm::launch(Cycles now) {
  const auto free = std::find_if(fronts_.begin(), fronts_.end(),
                                 [](const Front& f) { return f.state == State::kEmpty; });
  if (free == fronts_.end() || !host_.next_warp(new_warp_)) {
    return false;
  }
  account_occupancy(now);
  const auto slot = static_cast<std::uint32_t>(free - fronts_.begin());
  Warp& warp = warps_[slot];
  warp.program = new_warp_.program;
  warp.number = new_warp_.number;
  warp.addresses.first_launch = warp.program.launch(0);
  warp.addresses.width = new_warp_.width;
  warp.judging = false;
  warp.launched = warp.data = now;
  warp.outstanding = 0;
  free->age = age_++;
  ++resident_;
  ++counts_.warps;
  SegmentWork work;
  if (!warp.program.next(work, warp.rays)) {
    retire(now, slot);
    return true;
  }
  begin_work(slot, work);
  make_ready(now, slot, now);
  return true;
}

void Sm::retire(Cycles now, std::uint32_t slot) {
  account_occupancy(now);
  const Warp& warp = warps_[slot];
  set_state(now, slot, State::kEmpty);
  --resident_;
  counts_.warp_cycles += now.value - warp.launched.value;
  host_.warp_retired(index_, warp.number, now - warp.launched);
  turns_.push_back(now + Cycles{1});
  turn_ = turns_.front();
}

void Sm::take_turn(Cycles now) {
  turns_.pop_front();
  turn_ = turns_.empty() ? kNoTurn : turns_.front();
  launch(now);
}

void Sm::set_state(Cycles now, std::uint32_t slot, State state) {
  Front& front = fronts_[slot];
  Scheduler& scheduler = schedulers_[front.scheduler];
  if (!scheduler.ready.empty()) {
    advance(now, front.scheduler);
  }
  account(now, scheduler);
  --scheduler.states[static_cast<std::size_t>(front.state)];
  ++scheduler.states[static_cast<std::size_t>(state)];
  if (front.state == State::kReady && state != State::kReady) {
    *std::find(scheduler.ready.begin(), scheduler.ready.end(), slot) = scheduler.ready.back();
    scheduler.ready.pop_back();
  } else if (front.state != State::kReady && state == State::kReady) {
    scheduler.ready.push_back(slot);
  }
  lsu_waiters_ += state == State::kLsu;
  lsu_waiters_ -= front.state == State::kLsu;
  front.state = state;
}

void Sm::make_ready(Cycles now, std::uint32_t slot, Cycles ready) {
  set_state(now, slot, State::kReady);
  fronts_[slot].ready = ready;
  book(now, fronts_[slot].scheduler);
}

void Sm::wake(Cycles now, std::uint32_t what, std::uint32_t value) {
  switch (what) {
    case kIssue:
      issue(now, value);
      return;
    case kLsuPort:
      run_lsu(now);
      return;
    case kData:
      calendar_.progress();
      make_ready(now, value, now);
      return;
    case kJudge:
      begin_judging(now, value);
      return;
    default:
      A2RT_CHECK(false, "unknown appointment of the SM");
  }
}

void Sm::begin_judging(Cycles now, std::uint32_t slot) {
  Warp& warp = warps_[slot];
  warp.judging = true;
  SegmentWork work;
  A2RT_CHECK(warp.program.next_judgement(warp.jobs, work), "no candidate to judge");
  begin_work(slot, work);
  make_ready(now, slot, now);
}

void Sm::rays_done(Cycles now, std::uint32_t slot, Cycles ready) {
  Warp& warp = warps_[slot];
  counts_.rt_warp_cycles += ready.value - warp.traced.value;
  SegmentWork work;
  if (!warp.program.next(work, warp.rays)) {
    // Nothing follows: the warp ends with its rays.
    warp.rays.fill(kNone);
  }
  begin_work(slot, work);
  make_ready(now, slot, ready);
}

void Sm::enter_rt(Cycles now, std::uint32_t slot) {
  set_state(now, slot, State::kInRt);
  rt_.accept(now, slot, warps_[slot].rays);
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
                     " warps, load/store queue " + std::to_string(lsu_sectors_) + " sectors" +
                     (lsu_blocked_ ? " blocked by MSHRs" : "") + "\n";
  for (std::size_t slot = 0; slot < warps_.size(); ++slot) {
    if (fronts_[slot].state != State::kEmpty) {
      text += "  slot " + std::to_string(slot) + " warp " + std::to_string(warps_[slot].number) +
              ": " + kStates[static_cast<std::size_t>(fronts_[slot].state)] +
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
