// The RT unit's way to memory: its L1 port.
#include <bit>

#include "a2rt/timing/rt_engine.h"

namespace a2rt::timing {
namespace {

// Thread-private memory for spills: far above anything a scene's structures occupy.
constexpr Address kSpillBase{std::uint64_t{1} << 44};
// Cycles' worth of requests that the port sends in one go.
constexpr Cycles kBurst{8};

}  // namespace

void RtEngine::send_store(Cycles now) {
  const Store store = stores_[stores_head_];
  l1_.write(now, port_, Address{store.line * kLineBytes}, store.sector, store.kind);
  ++counts_.stores_sent;
  if (++stores_head_ == stores_.size()) {
    stores_.clear();
    stores_head_ = 0;
  }
}

A2RT_INLINE void RtEngine::send_request(Cycles now, Slot& slot) {
  RequestTable& requests = slot.requests;
  const RequestTable::Next next = requests.next();
  const L1Cache::Lookup found = l1_.read(now, port_, next.line, next.sectors, next.kind, *this,
                                         slot.index << 16 | next.token);
  requests.sent(found.accepted);
  update_asking(slot);
  counts_.sectors_sent += sectors_in(found.accepted);
  port_blocked_ = found.mshrs_full;
  if (found.hits != 0) {
    settle(now, slot, next.token, found.hits, found.ready);
  }
}

// Sends what is queued for the next few cycles. An older warp that asks meanwhile waits so long.
void RtEngine::run_port(Cycles now) {
  account_cycles(now);
  port_booked_ = false;
  const std::uint64_t cycles_before = port_.cycles_used();
  const std::uint64_t conflicts_before = l1_.counts().bank_conflicts;
  const Cycles burst_end = now + kBurst;
  while (!port_blocked_ && port_.next(now) < burst_end) {
    if (stores_head_ < stores_.size()) [[unlikely]] {
      send_store(now);
      continue;
    }
    if (asking_ == 0) {
      break;
    }
    send_request(now, *by_age_[static_cast<std::size_t>(std::countr_zero(asking_))]);
  }
  const std::uint64_t used = port_.cycles_used() - cycles_before;
  if (used > 0) {
    calendar_.progress();
    const Cycles end = port_.end();
    testing_.take(end);
    attribution_.until(end, l1_.counts().bank_conflicts - conflicts_before, RtReason::kBankBusy,
                       RtReason::kFetch);
    port_series_.add(end - Cycles{used}, end, 1);
  }
  if (stores_head_ < stores_.size() || asking_ != 0) {
    kick_port(now);
  }
}

void RtEngine::arrived(Cycles now, std::uint32_t token, SectorMask sectors,
                       const SectorTimes& ready) {
  calendar_.progress();
  settle(now, slots_[token >> 16], token & 0xffff, sectors, ready);
}

void RtEngine::unblocked(Cycles now) {
  account_cycles(now);
  port_blocked_ = false;
  kick_port(now);
}

// The lane has all lines of its read at `at`.
A2RT_INLINE void RtEngine::proceed(Cycles now, Cycles at, Slot& slot, std::uint32_t l) {
  Lane& lane = slot.lanes[l];
  end(LaneReason::kFetch, at);
  const Cycles next = lane.op->is_test() ? run_tests(now, at, lane) : at;
  if (next > now) [[likely]] {
    appoint(now, next, slot, l);
    // Mostly a read comes next; if not, nothing is lost.
    slot.requests.prefetch(lane.op->line());
    l1_.prefetch(Address{lane.op->line() * kLineBytes});
  } else {
    run_lane(now, next, slot, l);
  }
}

// Lanes whose last line has a time go on from it.
void RtEngine::settle(Cycles now, Slot& slot, std::uint32_t token, SectorMask sectors,
                      const SectorTimes& ready) {
  slot.requests.arrived(token, sectors, ready, [&](std::uint32_t l, Cycles at, bool complete) {
    Lane& lane = slot.lanes[l];
    lane.ready = std::max(lane.ready, at);
    lane.missing = static_cast<std::uint16_t>(lane.missing - complete);
    if (lane.missing == 0) {
      proceed(now, lane.ready, slot, l);
    }
  });
}

Address RtEngine::spill_memory(const Slot& slot, std::uint32_t lane) const {
  const std::uint64_t thread = (std::uint64_t{index_} * slots_.size() + slot.index) * kLanes + lane;
  return kSpillBase + Bytes{thread * kSpillBytesPerLane};
}

}  // namespace a2rt::timing
