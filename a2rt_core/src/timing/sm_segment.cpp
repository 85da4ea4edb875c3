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

void Sm::begin_work(std::uint32_t slot, const SegmentWork& work) {
  using capture::Counter;
  Warp& warp = warps_[slot];
  const std::uint32_t words = config_.sm.words_per_load;
  const std::uint32_t payload = ceil_div(count_of(work, Counter::kPayload), words);
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
  warp.addresses.lanes = work.lanes;
  if (warp.loads_left[0] > 0) {
    addresses_.find_records(work.shader, warp.program, warp.addresses);
  }
  fronts_[slot].uniform = ceil_div(count_of(work, Counter::kUniformLoad), words);
  begin_phase(slot);
}

// Arithmetic is spread evenly over the phases, each of which ends with a batch of loads.
void Sm::begin_phase(std::uint32_t slot) {
  Warp& warp = warps_[slot];
  Front& front = fronts_[slot];
  front.alu = ceil_div(warp.alu, warp.phases);
  front.sfu = ceil_div(warp.sfu, warp.phases);
  front.span = bursts_span(front.uniform, config_.sm.uniform_latency) +
               bursts_span(front.alu, config_.sm.alu_latency);
  warp.loads_phase = std::min(warp.loads, config_.sm.loads_in_flight);
  warp.alu -= front.alu;
  warp.sfu -= front.sfu;
  warp.loads -= warp.loads_phase;
  --warp.phases;
}

// How long so many instructions take a warp alone.
Cycles Sm::bursts_span(std::uint32_t instructions, Cycles latency) const {
  return latency * ceil_div(instructions, config_.sm.independent_instructions) +
         Cycles{instructions - ceil_div(instructions, config_.sm.independent_instructions)};
}

// The warp is ready, so up to `now` its scheduler waited for results.
void Sm::spend(Cycles now, Scheduler& scheduler, std::uint32_t slots, SchedulerReason reason) {
  A2RT_CHECK(now >= scheduler.free, "a scheduler issued twice in one cycle");
  scheduler.free = now + Cycles{slots};
  scheduler.attribution.until(scheduler.free, slots, reason, SchedulerReason::kWaitDependency);
}

// What a warp does in cycle `now` once its phase's arithmetic is done.
bool Sm::step(Cycles now, std::uint32_t slot, Scheduler& scheduler) {
  A2RT_CHECK(now == calendar_.now(), "a warp left its arithmetic in the past");
  const Warp& warp = warps_[slot];
  if (warp.loads_phase > 0) {
    return issue_load(now, slot, scheduler);
  }
  if (warp.phases > 0) {
    begin_phase(slot);
    return false;
  }
  if (warp.stores > 0) {
    return issue_store(now, slot, scheduler);
  }
  return end_segment(now, slot, scheduler);
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
  spend(at, scheduler, 1, SchedulerReason::kIssueSfu);
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
  A2RT_CHECK(at >= scheduler.free, "a scheduler issued twice in one cycle");
  scheduler.free = last + Cycles{in_last};
  scheduler.attribution.until(scheduler.free, issued, SchedulerReason::kIssueAlu,
                              SchedulerReason::kWaitDependency);
  front.ready = last + Cycles{in_last - 1} + latency;
  front.span = front.span - (front.ready - at);
  return issued;
}

// Puts an access into the queue: one entry per line.
void Sm::queue_lines(Cycles now, std::uint32_t slot, ShaderAccess access, std::uint32_t ordinal,
                     bool write) {
  Warp& warp = warps_[slot];
  std::uint32_t count = 0;
  addresses_.lines(access, ordinal, warp.addresses, [&](std::uint64_t line, SectorMask sectors) {
    lsu_.push_back({line, slot, sectors, write});
    count += sectors_in(sectors);
  });
  warp.outstanding += write ? 0 : count;
  lsu_sectors_ += count;
  counts_.lsu_sectors += count;
  kick_lsu(now);
}

bool Sm::issue_load(Cycles now, std::uint32_t slot, Scheduler& scheduler) {
  Warp& warp = warps_[slot];
  Front& front = fronts_[slot];
  if (lsu_sectors_ >= config_.sm.lsu_queue) {
    set_state(now, slot, State::kLsu);
    return false;
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
    front.ready = now + (warp.loads_phase > 0 ? Cycles{1} : config_.l1.latency);
    return true;
  }
  queue_lines(now, slot, kAccess[kind], ordinal, false);
  front.ready = now + Cycles{1};
  if (warp.loads_phase == 0 && (warp.outstanding > 0 || warp.data > front.ready)) {
    set_state(now, slot, State::kMemory);
    data_known(now, slot);
  }
  return true;
}

bool Sm::issue_store(Cycles now, std::uint32_t slot, Scheduler& scheduler) {
  Warp& warp = warps_[slot];
  if (lsu_sectors_ >= config_.sm.lsu_queue) {
    set_state(now, slot, State::kLsu);
    return false;
  }
  const std::size_t kind = warp.stores_left[0] > 0 ? 0 : 1;
  const std::uint32_t ordinal = --warp.stores_left[kind];
  --warp.stores;
  ++counts_.stores;
  spend(now, scheduler, 1, SchedulerReason::kIssueMemory);
  if (config_.shader_memory != ShaderMemory::kIdeal) {
    queue_lines(now, slot, kind == 0 ? ShaderAccess::kBufferStore : ShaderAccess::kPayload, ordinal,
                true);
  }
  fronts_[slot].ready = now + Cycles{1};
  return true;
}

bool Sm::end_segment(Cycles now, std::uint32_t slot, Scheduler& scheduler) {
  Warp& warp = warps_[slot];
  if (warp.judging) {
    SegmentWork work;
    if (warp.program.next_judgement(warp.jobs, work)) {
      begin_work(slot, work);
      return false;
    }
    warp.judging = false;
    set_state(now, slot, State::kInRt);
    rt_.candidates_done(now, slot);
    return false;
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
    return true;
  }
  SegmentWork work;
  if (warp.program.next(work, warp.rays)) {
    begin_work(slot, work);
    return false;
  }
  retire(now, slot);
  return false;
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
  calendar_.at(lsu_port_.next(now), *this, kLsuPort);
}

// When all of a waiting warp's loads have a time, it is ready at the last.
void Sm::data_known(Cycles now, std::uint32_t slot) {
  const Warp& warp = warps_[slot];
  if (warp.outstanding == 0 && fronts_[slot].state == State::kMemory) {
    calendar_.at(std::max(now, warp.data), *this, kData, slot);
  }
}

void Sm::send(Cycles now, LsuEntry& entry) {
  if (entry.write) {
    l1_.write(now, lsu_port_, Address{entry.line * kLineBytes}, entry.sectors, Traffic::kShader);
    lsu_sectors_ -= sectors_in(entry.sectors);
    entry.sectors = 0;
    return;
  }
  const L1Cache::Lookup found = l1_.read(now, lsu_port_, Address{entry.line * kLineBytes},
                                         entry.sectors, Traffic::kShader, *this, entry.slot);
  lsu_blocked_ = found.mshrs_full;
  lsu_sectors_ -= sectors_in(found.accepted);
  entry.sectors = static_cast<SectorMask>(entry.sectors & ~found.accepted);
  if (found.hits != 0) {
    Warp& warp = warps_[entry.slot];
    for_each_bit(found.hits,
                 [&](std::uint32_t s) { warp.data = std::max(warp.data, found.ready[s]); });
    warp.outstanding -= sectors_in(found.hits);
    data_known(now, entry.slot);
  }
}

// Sends what is queued for the next few cycles.
void Sm::run_lsu(Cycles now) {
  lsu_booked_ = false;
  const Cycles end = now + Cycles{4};
  while (lsu_head_ < lsu_.size() && !lsu_blocked_ && lsu_port_.next(now) < end) {
    send(now, lsu_[lsu_head_]);
    calendar_.progress();
    lsu_head_ += lsu_[lsu_head_].sectors == 0;
  }
  if (lsu_head_ == lsu_.size()) {
    lsu_.clear();
    lsu_head_ = 0;
  }
  if (lsu_waiters_ > 0 && lsu_sectors_ < config_.sm.lsu_queue) {
    const Cycles again = std::max(now + Cycles{1}, lsu_port_.end());
    for (std::uint32_t slot = 0; slot < fronts_.size(); ++slot) {
      if (fronts_[slot].state == State::kLsu) {
        make_ready(now, slot, again);
      }
    }
  }
  kick_lsu(now);
}

void Sm::arrived(Cycles now, std::uint32_t token, SectorMask sectors, const SectorTimes& ready) {
  calendar_.progress();
  Warp& warp = warps_[token];
  A2RT_CHECK(warp.outstanding >= sectors_in(sectors),
             "load data came for a warp that loads nothing");
  for_each_bit(sectors, [&](std::uint32_t s) { warp.data = std::max(warp.data, ready[s]); });
  warp.outstanding -= sectors_in(sectors);
  data_known(now, token);
}

void Sm::unblocked(Cycles now) {
  lsu_blocked_ = false;
  kick_lsu(now);
}

}  // namespace a2rt::timing
