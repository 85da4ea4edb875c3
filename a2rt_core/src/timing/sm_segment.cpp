// How a warp begins a segment, goes from phase to phase, and leaves for a trace or the next one.
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
  warp.accesses = {ceil_div(count_of(work, Counter::kBufferLoad), words),
                   count_of(work, Counter::kTexture), payload - payload / 2,
                   ceil_div(count_of(work, Counter::kBufferStore), words), payload / 2};
  warp.access = 0;
  warp.loads = warp.accesses[0] + warp.accesses[1] + warp.accesses[2];
  warp.stores = warp.accesses[3] + warp.accesses[4];
  warp.phases = ceil_div(warp.loads, config_.sm.loads_in_flight) + 1;
  for (std::size_t c = 0; c < capture::kCounters; ++c) {
    counts_.lane_operations[c] += work.lane_sum[c];
  }
  warp.addresses.lanes = work.lanes;
  if (warp.accesses[0] > 0) {
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
    spend(now, now + Cycles{1}, scheduler, 1, SchedulerReason::kIssueTrace);
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

}  // namespace a2rt::timing
