// The RT unit's way to memory: L1 port, short stack, contexts.
#include <bit>

#include "a2rt/timing/rt_engine.h"

namespace a2rt::timing {
namespace {

// Thread-private memory for spills: far above anything a scene's structures occupy.
constexpr std::uint64_t kSpillBase = std::uint64_t{1} << 44;
constexpr std::uint64_t kSpillBytesPerLane = 4096;
constexpr std::uint64_t kStackArea = 0;
constexpr std::uint64_t kContextArea = kSpillBytesPerLane / 2;
// Cycles' worth of requests that the port sends in one go.
constexpr Cycles kBurst{8};

}  // namespace

void RtEngine::kick_port(Cycles now) {
  if (port_booked_ || port_blocked_) {
    return;
  }
  port_booked_ = true;
  calendar_.at(port_.next(now), *this, kPort);
}

std::uint32_t RtEngine::oldest_with_requests() const {
  for (const std::uint32_t slot : by_age_) {
    if (!slots_[slot]->requests.nothing_to_send()) {
      return slot;
    }
  }
  return static_cast<std::uint32_t>(slots_.size());
}

void RtEngine::send_store(Cycles now) {
  const Store store = stores_[stores_head_];
  l1_.write(now, port_, Address{store.line * kLineBytes}, store.sector, store.kind);
  ++counts_.stores_sent;
  if (++stores_head_ == stores_.size()) {
    stores_.clear();
    stores_head_ = 0;
  }
}

void RtEngine::send_request(Cycles now, std::uint32_t slot) {
  RequestTable& requests = slots_[slot]->requests;
  const RequestTable::Next next = requests.next();
  const L1Cache::Lookup found =
      l1_.read(now, port_, next.line, next.sectors, next.kind, *this, slot << 16 | next.token);
  requests.sent(found.accepted);
  counts_.sectors_sent += sectors_in(found.accepted);
  port_blocked_ = found.mshrs_full;
  if (found.hits != 0) {
    settle(now, slot, next.token, found.hits, found.ready);
  }
}

// Sends what is queued for the next few cycles. An older warp that asks meanwhile waits so long.
void RtEngine::run_port(Cycles now) {
  account(now);
  port_booked_ = false;
  const std::uint64_t cycles_before = port_.cycles_used();
  const std::uint64_t conflicts_before = l1_.counts().bank_conflicts;
  const Cycles burst_end = now + kBurst;
  bool more = true;
  while (!port_blocked_ && port_.next(now) < burst_end) {
    const std::uint32_t slot = oldest_with_requests();
    if (stores_head_ < stores_.size()) {
      send_store(now);
    } else if (slot < slots_.size()) {
      send_request(now, slot);
    } else {
      more = false;
      break;
    }
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
  if (more && !port_blocked_ &&
      (stores_head_ < stores_.size() || oldest_with_requests() < slots_.size())) {
    kick_port(now);
  }
}

void RtEngine::arrived(Cycles now, std::uint32_t token, SectorMask sectors,
                       const SectorTimes& ready) {
  calendar_.progress();
  settle(now, token >> 16, token & 0xffff, sectors, ready);
}

void RtEngine::unblocked(Cycles now) {
  account(now);
  port_blocked_ = false;
  kick_port(now);
}

// Lanes whose last line has a time go on from it.
void RtEngine::settle(Cycles now, std::uint32_t slot, std::uint32_t token, SectorMask sectors,
                      const SectorTimes& ready) {
  Slot& s = *slots_[slot];
  s.requests.arrived(token, sectors, ready, [&](std::uint32_t l, Cycles at, bool complete) {
    Lane& lane = s.lanes[l];
    lane.ready = std::max(lane.ready, at);
    if (complete && --lane.missing == 0) {
      book_lane(lane, lane.ready, LaneReason::kFetch);
      lane.state = LaneState::kRun;
      run_lane(now, lane.ready, slot, l);
    }
  });
}

Address RtEngine::stack_address(std::uint32_t slot, std::uint32_t lane, std::uint32_t entry,
                                std::uint32_t bytes, std::uint64_t area) const {
  const std::uint64_t thread =
      (static_cast<std::uint64_t>(index_) * slots_.size() + slot) * kLanes + lane;
  const std::uint64_t offset = static_cast<std::uint64_t>(entry) * bytes % (kSpillBytesPerLane / 2);
  return Address{kSpillBase + thread * kSpillBytesPerLane + area + offset};
}

void RtEngine::store(Cycles now, Address address, std::uint32_t bytes, Traffic kind) {
  const Address last = sector_of(Address{address.value + bytes - 1});
  for (Address s = sector_of(address); s <= last; s = s + Bytes{kSectorBytes}) {
    stores_.push_back({line_of(s), static_cast<SectorMask>(1u << sector_index(s)), kind});
  }
  kick_port(now);
}

// Entries leave for memory a sector at a time, oldest first, so that one store moves several.
void RtEngine::push(Cycles now, std::uint32_t slot, std::uint32_t l, std::uint32_t count) {
  Lane& lane = slots_[slot]->lanes[l];
  const std::uint32_t limit = config_.rt.stack_entries;
  const std::uint32_t bytes = config_.rt.stack_entry_bytes;
  const auto per_sector = static_cast<std::uint32_t>(kSectorBytes) / bytes;
  lane.stack += count;
  counts_.stack_pushed += count;
  while (limit > 0 && lane.stack > limit) {
    const std::uint32_t moved = std::min(per_sector, lane.stack);
    store(now, stack_address(slot, l, lane.stack_spilled, bytes, kStackArea), moved * bytes,
          Traffic::kStack);
    lane.stack -= moved;
    lane.stack_spilled += moved;
    ++counts_.stack_spills;
    counts_.stack_spilled += moved;
  }
}

bool RtEngine::pop(Cycles now, std::uint32_t slot, std::uint32_t l, std::uint32_t count) {
  Lane& lane = slots_[slot]->lanes[l];
  A2RT_CHECK(count <= lane.stack + lane.stack_spilled, "a ray pops more than it pushed");
  counts_.stack_popped += count;
  if (lane.stack >= count) {
    lane.stack -= count;
    return false;
  }
  const std::uint32_t bytes = config_.rt.stack_entry_bytes;
  const auto per_sector = static_cast<std::uint32_t>(kSectorBytes) / bytes;
  const std::uint32_t lacking = count - lane.stack;
  const std::uint32_t moved =
      std::min(lane.stack_spilled, (lacking + per_sector - 1) / per_sector * per_sector);
  lane.stack_spilled -= moved;
  lane.stack = lane.stack + moved - count;
  counts_.stack_fills += (moved + per_sector - 1) / per_sector;
  counts_.stack_filled += moved;
  read_spill(now, slot, l, stack_address(slot, l, lane.stack_spilled, bytes, kStackArea),
             moved * bytes);
  return true;
}

void RtEngine::push_context(Cycles now, std::uint32_t slot, std::uint32_t l) {
  Lane& lane = slots_[slot]->lanes[l];
  ++lane.context;
  if (config_.rt.context == ContextPolicy::kRefetch) {
    return;
  }
  ++counts_.context_saves;
  const std::uint32_t limit = config_.rt.context_entries;
  if (limit == 0 || lane.context <= limit) {
    return;
  }
  const std::uint32_t bytes = config_.rt.context_bytes;
  store(now, stack_address(slot, l, lane.context_spilled, bytes, kContextArea), bytes,
        Traffic::kStack);
  --lane.context;
  ++lane.context_spilled;
  ++counts_.context_spills;
}

bool RtEngine::pop_context(Cycles now, std::uint32_t slot, std::uint32_t l) {
  Lane& lane = slots_[slot]->lanes[l];
  A2RT_CHECK(lane.context + lane.context_spilled > 0, "a ray restores a context it never saved");
  ++counts_.context_restores;
  if (lane.context > 0) {
    --lane.context;
    return false;
  }
  --lane.context_spilled;
  ++counts_.context_fills;
  const std::uint32_t bytes = config_.rt.context_bytes;
  read_spill(now, slot, l, stack_address(slot, l, lane.context_spilled, bytes, kContextArea),
             bytes);
  return true;
}

}  // namespace a2rt::timing
