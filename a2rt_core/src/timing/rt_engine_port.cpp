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

}  // namespace

void RtEngine::kick_port(Cycles now) {
  if (port_booked_ || port_blocked_) {
    return;
  }
  port_booked_ = true;
  calendar_.at(std::max(now, port_free_), *this, kPort);
}

std::uint32_t RtEngine::oldest_with_requests() const {
  for (const std::uint32_t slot : by_age_) {
    if (!slots_[slot]->requests.nothing_to_send()) {
      return slot;
    }
  }
  return static_cast<std::uint32_t>(slots_.size());
}

bool RtEngine::send_store(Cycles now) {
  if (l1_.write(now, stores_[stores_head_], Traffic::kStack) != L1Cache::Reply::kAccepted) {
    bank_busy_ = true;
    return false;
  }
  ++counts_.stores_sent;
  if (++stores_head_ == stores_.size()) {
    stores_.clear();
    stores_head_ = 0;
  }
  return true;
}

bool RtEngine::send_request(Cycles now, std::uint32_t slot) {
  RequestTable& requests = slots_[slot]->requests;
  const RequestTable::Next next = requests.next();
  switch (l1_.read(now, next.sector, next.kind, *this, slot << 16 | next.token)) {
    case L1Cache::Reply::kAccepted:
      requests.sent();
      ++counts_.sectors_sent;
      return true;
    case L1Cache::Reply::kBankBusy:
      bank_busy_ = true;
      return false;
    case L1Cache::Reply::kMshrFull:
      port_blocked_ = true;
      return false;
  }
  return false;
}

void RtEngine::run_port(Cycles now) {
  account(now);
  port_booked_ = false;
  bool sent = false;
  bool more = true;
  while (more && port_.left(now) > 0) {
    const std::uint32_t slot = oldest_with_requests();
    bool accepted = false;
    if (stores_head_ < stores_.size()) {
      accepted = send_store(now);
    } else if (slot < slots_.size()) {
      accepted = send_request(now, slot);
    } else {
      more = false;
    }
    if (accepted) {
      port_.spend(now);
      sent = true;
    } else {
      break;
    }
  }
  // The next RT clock edge is the earliest moment for another request.
  port_free_ = clock_.to_core(clock_.from_core(now) + Cycles{1});
  if (sent) {
    calendar_.progress();
    attribution_.until(now + Cycles{1}, RtReason::kFetch);
  } else if (bank_busy_) {
    attribution_.until(now + Cycles{1}, RtReason::kBankBusy);
  }
  bank_busy_ = false;
  if (stores_head_ < stores_.size() || oldest_with_requests() < slots_.size()) {
    kick_port(now);
  }
}

void RtEngine::data(Cycles now, std::uint32_t token) {
  calendar_.progress();
  const std::uint32_t slot = token >> 16;
  Slot& s = *slots_[slot];
  std::uint32_t lanes = s.requests.arrived(token & 0xffff);
  while (lanes != 0) {
    const auto l = static_cast<std::uint32_t>(std::countr_zero(lanes));
    lanes &= lanes - 1;
    if (--s.lanes[l].missing == 0) {
      run_lane(now, slot, l);
    }
  }
}

Address RtEngine::stack_address(std::uint32_t slot, std::uint32_t lane, std::uint32_t entry,
                                std::uint32_t bytes, std::uint64_t area) const {
  const std::uint64_t thread =
      (static_cast<std::uint64_t>(index_) * slots_.size() + slot) * kLanes + lane;
  const std::uint64_t offset = static_cast<std::uint64_t>(entry) * bytes % (kSpillBytesPerLane / 2);
  return Address{kSpillBase + thread * kSpillBytesPerLane + area + offset};
}

void RtEngine::store(Cycles now, Address address, std::uint32_t bytes) {
  const Address last = sector_of(Address{address.value + bytes - 1});
  for (Address s = sector_of(address); s <= last; s = s + Bytes{kSectorBytes}) {
    stores_.push_back(s);
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
  while (limit > 0 && lane.stack > limit) {
    const std::uint32_t moved = std::min(per_sector, lane.stack);
    store(now, stack_address(slot, l, lane.stack_spilled, bytes, kStackArea), moved * bytes);
    lane.stack -= moved;
    lane.stack_spilled += moved;
    ++counts_.stack_spills;
  }
}

bool RtEngine::pop(Cycles now, std::uint32_t slot, std::uint32_t l, std::uint32_t count) {
  Lane& lane = slots_[slot]->lanes[l];
  A2RT_CHECK(count <= lane.stack + lane.stack_spilled, "a ray pops more than it pushed");
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
  return fetch(now, slot, l, stack_address(slot, l, lane.stack_spilled, bytes, kStackArea),
               moved * bytes, Traffic::kStack);
}

void RtEngine::push_context(Cycles now, std::uint32_t slot, std::uint32_t l) {
  Lane& lane = slots_[slot]->lanes[l];
  ++lane.context;
  const std::uint32_t limit = config_.rt.context_entries;
  if (config_.rt.context == ContextPolicy::kRefetch || limit == 0 || lane.context <= limit) {
    return;
  }
  const std::uint32_t bytes = config_.rt.context_bytes;
  store(now, stack_address(slot, l, lane.context_spilled, bytes, kContextArea), bytes);
  --lane.context;
  ++lane.context_spilled;
  ++counts_.context_spills;
}

bool RtEngine::pop_context(Cycles now, std::uint32_t slot, std::uint32_t l, const Event& event) {
  Lane& lane = slots_[slot]->lanes[l];
  A2RT_CHECK(lane.context + lane.context_spilled > 0, "a ray restores a context it never saved");
  if (config_.rt.context == ContextPolicy::kRefetch) {
    --lane.context;
    ++counts_.context_refetches;
    const bool anchors = pools_[static_cast<std::size_t>(Tester::kAnchor)].exists();
    if (anchors) {
      follow(lane, {Tester::kAnchor, 1}, {});
    } else {
      follow(lane, {Tester::kBox, 1}, {Tester::kQuantizer, 1});
    }
    return fetch(now, slot, l, Address{event.address}, event.bytes,
                 anchors ? Traffic::kAnchor : Traffic::kGroupNode);
  }
  if (lane.context > 0) {
    --lane.context;
    return false;
  }
  --lane.context_spilled;
  ++counts_.context_fills;
  const std::uint32_t bytes = config_.rt.context_bytes;
  return fetch(now, slot, l, stack_address(slot, l, lane.context_spilled, bytes, kContextArea),
               bytes, Traffic::kStack);
}

}  // namespace a2rt::timing
