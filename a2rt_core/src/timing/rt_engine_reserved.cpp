// The RT unit's way to memory in the model "reserved": no queue stands before the port, as every
// line has its turn there when it is asked for, first come first served.
#include <algorithm>

#include "a2rt/timing/rt_engine.h"

namespace a2rt::timing {

// Books the cycles of the port that `send` takes.
template <class Send>
A2RT_INLINE void RtEngine::through_port(Cycles now, const Send& send) {
  const Cycles from = std::max(port_.next(now), port_.end());
  const std::uint64_t used = port_.cycles_used();
  send();
  const Cycles end = port_.end();
  if (end > from) [[likely]] {
    sending_.mark(from, end);
    port_series_.add(end - Cycles{port_.cycles_used() - used}, end, 1);
  }
}

// Mostly a lane's next operation is a read; if not, nothing is lost.
A2RT_INLINE void RtEngine::prefetch_line(const Slot& slot, LaneOp op) const {
  l1_.prefetch(Address{op.line() * kLineBytes});
  on_its_way_.prefetch(line_of_warp(slot, op));
}

// When the line's sectors are there; those on their way to another lane of the warp are shared.
A2RT_INLINE Cycles RtEngine::fetch_line(Cycles now, const Slot& slot, LaneOp op) {
  ComingLines::Line& known = on_its_way_.obtain(now, line_of_warp(slot, op));
  const SectorMask shared = known.coming(now, op.sectors());
  const auto wanted = static_cast<SectorMask>(op.sectors() ^ shared);
  if (wanted == 0) {
    return known.there();
  }
  counts_.sectors_sent += sectors_in(wanted);
  const Cycles ready =
      l1_.read_ahead(now, port_, Address{op.line() * kLineBytes}, wanted, op.kind());
  const Cycles both = shared == 0 ? ready : std::max(ready, known.there());
  known.add(now, wanted, ready);
  return both;
}

A2RT_INLINE void RtEngine::read_ahead(Cycles now, Slot& slot, std::uint32_t l, LaneOp op) {
  Lane& lane = slot.lanes[l];
  const LaneOp* next = lane.op;
  Cycles ready = now;
  through_port(now, [&] {
    while (true) {
      ready = std::max(ready, fetch_line(now, slot, op));
      if (op.last()) {
        break;
      }
      op = *next++;
    }
  });
  __builtin_prefetch(next + kOpsPerHostLine);
  lane.op = next;
  calendar_.promise(ready);
  lane_cycles(LaneReason::kFetch) += ready.value - now.value;
  const Cycles at = next->is_test() ? run_tests(now, ready, lane) : ready;
  calendar_.at(at, *this, kLaneAhead, slot.index * kLanes + l);
  prefetch_line(slot, *lane.op);
}

A2RT_INLINE void RtEngine::go_on_ahead(Cycles now, Slot& slot, std::uint32_t l) {
  Lane& lane = slot.lanes[l];
  if (lane.op->code() == LaneOp::Code::kRead) [[likely]] {
    const LaneOp op = *lane.op++;
    read_ahead(now, slot, l, op);
  } else {
    run_lane(now, now, slot, l);
  }
}

void RtEngine::store_ahead(Cycles now, LaneOp op) {
  through_port(now, [&] {
    l1_.write(now, port_, Address{op.line() * kLineBytes}, op.sectors(), op.kind());
  });
  ++counts_.stores_sent;
}

// Brings what the appointments before `end` touch into the host's caches. What one step reads has
// been fetched by the one before, so that none waits for memory.
void RtEngine::prefetch_before(Cycles now, Cycles end) {
  for (const TesterPool& pool : pools_) {
    pool.prefetch(now, end);
  }
  appointed_.clear();
  calendar_.each_before(end, [&](const Component* who, std::uint32_t what, std::uint32_t value) {
    if (who == this && what == kLaneAhead) {
      const Slot& slot = slots_[value / kLanes];
      appointed_.push_back({&slot, &slot.lanes[value % kLanes]});
      __builtin_prefetch(appointed_.back().lane, 1);
    }
  });
  for (const Appointed& a : appointed_) {
    __builtin_prefetch(a.lane->op);
  }
  for (const Appointed& a : appointed_) {
    prefetch_line(*a.slot, *a.lane->op);
  }
}

}  // namespace a2rt::timing
