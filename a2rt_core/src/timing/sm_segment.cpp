// A warp's way through one segment: arithmetic, loads, stores, then a trace or the next segment.
#include <algorithm>

#include "a2rt/timing/sm.h"

namespace a2rt::timing {
namespace {

std::uint32_t ceil_div(std::uint32_t a, std::uint32_t b) { return (a + b - 1) / b; }
std::uint32_t count_of(const SegmentWork& work, capture::Counter counter) {
  return work.counts[static_cast<std::size_t>(counter)];
}

}  // namespace

void Sm::begin_work(Warp& warp) {
  using capture::Counter;
  const SegmentWork& work = warp.work;
  const std::uint32_t words = config_.sm.words_per_load;
  const std::uint32_t payload = ceil_div(count_of(work, Counter::kPayload), words);
  warp.uniform = ceil_div(count_of(work, Counter::kUniformLoad), words);
  warp.alu = count_of(work, Counter::kAlu) + count_of(work, Counter::kControl);
  warp.sfu = count_of(work, Counter::kSfu);
  // The capture counts payload words without direction: half are taken as loads.
  warp.loads_left = {ceil_div(count_of(work, Counter::kBufferLoad), words),
                     count_of(work, Counter::kTexture), payload - payload / 2};
  warp.stores_left = {ceil_div(count_of(work, Counter::kBufferStore), words), payload / 2};
  warp.loads = warp.loads_left[0] + warp.loads_left[1] + warp.loads_left[2];
  warp.stores = warp.stores_left[0] + warp.stores_left[1];
  warp.phases = ceil_div(warp.loads, config_.sm.loads_in_flight) + 1;
  for (std::size_t c = 0; c < capture::kCounters; ++c) {
    counts_.lane_operations[c] += work.lane_sum[c];
  }
  begin_phase(warp);
}

// Arithmetic is spread evenly over the phases, each of which ends with a batch of loads.
void Sm::begin_phase(Warp& warp) {
  warp.alu_phase = ceil_div(warp.alu, warp.phases);
  warp.sfu_phase = ceil_div(warp.sfu, warp.phases);
  warp.loads_phase = std::min(warp.loads, config_.sm.loads_in_flight);
  warp.alu -= warp.alu_phase;
  warp.sfu -= warp.sfu_phase;
  warp.loads -= warp.loads_phase;
  --warp.phases;
}

void Sm::spend(Cycles now, Scheduler& scheduler, std::uint32_t slots, SchedulerReason reason) {
  A2RT_CHECK(now >= scheduler.free, "a scheduler issued twice in one cycle");
  account(now, scheduler);
  scheduler.free = now + Cycles{slots};
  scheduler.attribution.until(scheduler.free, reason);
}

Sm::Issue Sm::step(Cycles now, std::uint32_t slot, std::uint32_t index) {
  Warp& warp = warps_[slot];
  Scheduler& scheduler = schedulers_[index];
  if (warp.uniform + warp.alu_phase + warp.sfu_phase > 0) {
    return issue_arithmetic(now, warp, scheduler);
  }
  if (warp.loads_phase > 0) {
    return issue_load(now, slot, scheduler);
  }
  if (warp.phases > 0) {
    begin_phase(warp);
    return Issue::kAgain;
  }
  if (warp.stores > 0) {
    return issue_store(now, slot, scheduler);
  }
  return end_segment(now, slot, scheduler);
}

Sm::Issue Sm::issue_arithmetic(Cycles now, Warp& warp, Scheduler& scheduler) {
  const SmConfig& sm = config_.sm;
  if (warp.uniform > 0 || warp.alu_phase > 0) {
    std::uint32_t& left = warp.uniform > 0 ? warp.uniform : warp.alu_phase;
    const Cycles latency = warp.uniform > 0 ? sm.uniform_latency : sm.alu_latency;
    const std::uint32_t burst = std::min(left, sm.independent_instructions);
    (warp.uniform > 0 ? counts_.uniform : counts_.alu) += burst;
    left -= burst;
    spend(now, scheduler, burst, SchedulerReason::kIssueAlu);
    warp.ready = now + Cycles{burst - 1} + latency;
    return Issue::kIssued;
  }
  if (scheduler.sfu_free > now) {
    warp.ready = scheduler.sfu_free;
    return Issue::kNothing;
  }
  --warp.sfu_phase;
  ++counts_.sfu;
  spend(now, scheduler, 1, SchedulerReason::kIssueSfu);
  scheduler.sfu_free = now + sm.sfu_interval;
  warp.ready = now + (warp.sfu_phase > 0 ? sm.sfu_interval : sm.sfu_latency);
  return Issue::kIssued;
}

void Sm::queue_sectors(Cycles now, std::uint32_t slot, ShaderAccess access, std::uint32_t ordinal,
                       bool write) {
  Warp& warp = warps_[slot];
  const std::uint32_t block = index_ * config_.sm.warps + slot;
  addresses_.sectors(access, ordinal, warp.work, warp.program, warp.width, block, scratch_);
  // Payload and attributes are thread-private like spilled stacks, but belong to the shaders.
  for (const Address sector : scratch_) {
    lsu_.push_back({sector, slot, write, Traffic::kShader});
    warp.outstanding += !write;
  }
  counts_.lsu_sectors += scratch_.size();
  kick_lsu(now);
}

Sm::Issue Sm::issue_load(Cycles now, std::uint32_t slot, Scheduler& scheduler) {
  Warp& warp = warps_[slot];
  if (lsu_.size() - lsu_head_ >= config_.sm.lsu_queue) {
    set_state(now, slot, State::kLsu);
    return Issue::kNothing;
  }
  static constexpr ShaderAccess kAccess[] = {ShaderAccess::kBufferLoad, ShaderAccess::kTexture,
                                             ShaderAccess::kPayload};
  std::size_t kind = 0;
  while (warp.loads_left[kind] == 0) {
    ++kind;
  }
  const std::uint32_t ordinal = --warp.loads_left[kind];
  --warp.loads_phase;
  ++counts_.loads;
  spend(now, scheduler, 1, SchedulerReason::kIssueMemory);
  if (config_.shader_memory == ShaderMemory::kIdeal) {
    warp.ready = now + (warp.loads_phase > 0 ? Cycles{1} : config_.l1.latency);
    return Issue::kIssued;
  }
  queue_sectors(now, slot, kAccess[kind], ordinal, false);
  warp.ready = now + Cycles{1};
  if (warp.loads_phase == 0 && warp.outstanding > 0) {
    set_state(now, slot, State::kMemory);
  }
  return Issue::kIssued;
}

Sm::Issue Sm::issue_store(Cycles now, std::uint32_t slot, Scheduler& scheduler) {
  Warp& warp = warps_[slot];
  if (lsu_.size() - lsu_head_ >= config_.sm.lsu_queue) {
    set_state(now, slot, State::kLsu);
    return Issue::kNothing;
  }
  const std::size_t kind = warp.stores_left[0] > 0 ? 0 : 1;
  const std::uint32_t ordinal = --warp.stores_left[kind];
  --warp.stores;
  ++counts_.stores;
  spend(now, scheduler, 1, SchedulerReason::kIssueMemory);
  if (config_.shader_memory != ShaderMemory::kIdeal) {
    queue_sectors(now, slot, kind == 0 ? ShaderAccess::kBufferStore : ShaderAccess::kPayload,
                  ordinal, true);
  }
  warp.ready = now + Cycles{1};
  return Issue::kIssued;
}

Sm::Issue Sm::end_segment(Cycles now, std::uint32_t slot, Scheduler& scheduler) {
  Warp& warp = warps_[slot];
  if (warp.judging) {
    if (warp.program.next_judgement(warp.jobs, warp.work)) {
      begin_work(warp);
      return Issue::kAgain;
    }
    warp.judging = false;
    set_state(now, slot, State::kInRt);
    rt_.candidates_done(now, slot);
    return Issue::kNothing;
  }
  const bool traces =
      std::any_of(warp.rays.begin(), warp.rays.end(), [](std::uint32_t r) { return r != kNone; });
  if (traces) {
    ++counts_.traces;
    spend(now, scheduler, 1, SchedulerReason::kIssueTrace);
    warp.traced = now;
    if (rt_.has_room() && waiting_for_rt_.empty()) {
      enter_rt(now, slot);
    } else {
      set_state(now, slot, State::kRtSlot);
      waiting_for_rt_.push_back(slot);
    }
    return Issue::kIssued;
  }
  if (warp.program.next(warp.work, warp.rays)) {
    begin_work(warp);
    return Issue::kAgain;
  }
  retire(now, slot);
  return Issue::kNothing;
}

void Sm::enter_rt(Cycles now, std::uint32_t slot) {
  set_state(now, slot, State::kInRt);
  rt_.accept(now, slot, warps_[slot].rays);
}

void Sm::kick_lsu(Cycles now) {
  if (lsu_booked_ || lsu_blocked_ || lsu_head_ == lsu_.size()) {
    return;
  }
  lsu_booked_ = true;
  calendar_.at(std::max(now, lsu_free_), *this, kLsuPort);
}

void Sm::run_lsu(Cycles now) {
  lsu_booked_ = false;
  lsu_free_ = now + Cycles{1};
  while (lsu_head_ < lsu_.size() && lsu_budget_.left(now) > 0) {
    const LsuEntry& entry = lsu_[lsu_head_];
    const L1Cache::Reply reply = entry.write
                                     ? l1_.write(now, entry.sector, entry.kind)
                                     : l1_.read(now, entry.sector, entry.kind, *this, entry.slot);
    if (reply == L1Cache::Reply::kMshrFull) {
      lsu_blocked_ = true;
    }
    if (reply != L1Cache::Reply::kAccepted) {
      break;
    }
    calendar_.progress();
    lsu_budget_.spend(now);
    ++lsu_head_;
  }
  if (lsu_head_ == lsu_.size()) {
    lsu_.clear();
    lsu_head_ = 0;
  }
  if (lsu_.size() - lsu_head_ < config_.sm.lsu_queue) {
    for (std::uint32_t slot = 0; slot < warps_.size(); ++slot) {
      if (warps_[slot].state == State::kLsu) {
        make_ready(now, slot, now + Cycles{1});
      }
    }
  }
  kick_lsu(now);
}

}  // namespace a2rt::timing
