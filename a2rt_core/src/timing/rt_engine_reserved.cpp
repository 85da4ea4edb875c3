// The RT unit's way to memory in the model "reserved": no queue stands before the port, as every
// line has its turn there when it is asked for, first come first served.
#include <algorithm>

#include "a2rt/timing/rt_engine.h"

namespace a2rt::timing {

// The next cycles of the port are the message's.
A2RT_INLINE Port::Sent RtEngine::send_ahead(Cycles now, std::uint32_t sectors) {
  const Port::Sent sent = port_.send(now, sectors);
  sending_.mark(sent.first, sent.last + Cycles{1});
  return sent;
}

// Adds the port's cycles to their series, at the front of what is booked: a stretch at most.
void RtEngine::book_port(Cycles now) {
  const Cycles from = attribution_.booked();
  const std::uint64_t n = std::min(port_.cycles_used() - port_cycles_booked_, (now - from).value);
  port_series_.add(from, from + Cycles{n}, 1);
  port_cycles_booked_ += n;
}

// Mostly a lane's next operation is a read; if not, nothing is lost.
A2RT_INLINE void RtEngine::prefetch_line(LaneOp op) const {
  l1_.prefetch(Address{op.line() * kLineBytes});
}

// When the line's sectors are there; those on their way to another lane of the warp are shared.
A2RT_INLINE Cycles RtEngine::fetch_line(Cycles now, const Slot& slot, LaneOp op) {
  return l1_.read_ahead(
      now, slot.index, Address{op.line() * kLineBytes}, op.sectors(),
      op.kind(), [&](std::uint32_t n) __attribute__((always_inline)) {
        counts_.sectors_sent += n;
        return send_ahead(now, n);
      });
}

A2RT_INLINE void RtEngine::read_ahead(Cycles now, Slot& slot, std::uint32_t l, LaneOp op) {
  Lane& lane = slot.lanes[l];
  const LaneOp* next = lane.op;
  Cycles ready = now;
  while (true) {
    ready = std::max(ready, fetch_line(now, slot, op));
    if (op.last()) {
      break;
    }
    op = *next++;
  }
  __builtin_prefetch(next + kOpsPerHostLine);
  lane.op = next;
  lane_cycles(LaneReason::kFetch) += ready.value - now.value;
  const Cycles at = next->is_test() ? run_tests(now, ready, lane) : ready;
  calendar_.at(at, slot.index * kLanes + l);
  prefetch_line(*lane.op);
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
  l1_.write_ahead(now, send_ahead(now, sectors_in(op.sectors())), Address{op.line() * kLineBytes},
                  op.sectors(), op.kind());
  ++counts_.stores_sent;
}

}  // namespace a2rt::timing
