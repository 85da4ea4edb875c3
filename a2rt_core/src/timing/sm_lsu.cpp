// The load/store unit of an SM: lines of its warps' accesses on their way to the L1.
#include <algorithm>

#include "a2rt/timing/sm.h"

namespace a2rt::timing {

// Some sectors that the warp loads got a time.
void Sm::add_data(Cycles now, std::uint32_t slot, SectorMask sectors, const SectorTimes& ready) {
  Warp& warp = warps_[slot];
  for_each_bit(sectors, [&](std::uint32_t s) { warp.data = std::max(warp.data, ready[s]); });
  warp.outstanding -= sectors_in(sectors);
  data_known(now, slot, warp);
}

void Sm::send(Cycles now, LsuEntry& entry) {
  const Address line{entry.line * kLineBytes};
  if (entry.write) {
    l1_.write(now, lsu_port_, line, entry.sectors, Traffic::kShader);
    lsu_sectors_ -= sectors_in(entry.sectors);
    entry.sectors = 0;
    return;
  }
  const L1Cache::Lookup found =
      l1_.read(now, lsu_port_, line, entry.sectors, Traffic::kShader, *this, entry.slot);
  lsu_blocked_ = found.mshrs_full;
  lsu_sectors_ -= sectors_in(found.accepted);
  entry.sectors = static_cast<SectorMask>(entry.sectors & ~found.accepted);
  if (found.hits != 0) {
    add_data(now, entry.slot, found.hits, found.ready);
  }
}

// Model "reserved": the lines have their turn at the port and are looked up now.
void Sm::access_ahead(Cycles now, Warp& warp, std::uint32_t ordinal, bool write) {
  addresses_.lines(
      kAccesses[warp.access], ordinal,
      warp.addresses, [&](std::uint64_t line, SectorMask sectors) __attribute__((always_inline)) {
        counts_.lsu_sectors += sectors_in(sectors);
        const Address address{line * kLineBytes};
        const Port::Sent sent = lsu_port_.send(now, sectors_in(sectors));
        if (write) {
          l1_.write_ahead(now, sent, address, sectors, Traffic::kShader);
        } else {
          warp.data = std::max(warp.data, l1_.read_ahead(sent, address, sectors, Traffic::kShader));
        }
      });
  calendar_.promise(warp.data);
}

// Whether as many sectors as the queue holds wait for the port; if so, those who find it full are
// woken when there is room.
bool Sm::lsu_full_ahead(Cycles now) {
  const SmConfig& sm = config_.sm;
  const std::uint64_t full_for =
      (sm.lsu_queue + sm.lsu_sectors_per_cycle - 1) / sm.lsu_sectors_per_cycle;
  if (lsu_port_.end() < now + Cycles{full_for}) {
    return false;
  }
  if (!lsu_booked_) {
    lsu_booked_ = true;
    calendar_.at(lsu_port_.end() - Cycles{full_for - 1}, *this, kLsuPort);
  }
  return true;
}

// Sends what is queued for the next few cycles.
void Sm::run_lsu(Cycles now) {
  lsu_booked_ = false;
  if (reserves_) {
    wake_lsu_waiters(now);
    return;
  }
  const Cycles end = now + Cycles{4};
  while (lsu_head_ < lsu_.size() && !lsu_blocked_ && lsu_port_.next(now) < end) {
    LsuEntry& entry = lsu_[lsu_head_];
    send(now, entry);
    calendar_.progress();
    lsu_head_ += entry.sectors == 0;
  }
  if (lsu_head_ == lsu_.size()) {
    lsu_.clear();
    lsu_head_ = 0;
  }
  if (lsu_waiters_ > 0 && lsu_sectors_ < config_.sm.lsu_queue) [[unlikely]] {
    wake_lsu_waiters(now);
  }
  kick_lsu(now);
}

void Sm::wake_lsu_waiters(Cycles now) {
  const Cycles again = reserves_ ? now : std::max(now + Cycles{1}, lsu_port_.end());
  for (std::uint32_t slot = 0; slot < fronts_.size(); ++slot) {
    if (fronts_[slot].state == State::kLsu) {
      make_ready(now, slot, again);
    }
  }
}

void Sm::arrived(Cycles now, std::uint32_t token, SectorMask sectors, const SectorTimes& ready) {
  calendar_.progress();
  A2RT_CHECK(warps_[token].outstanding >= sectors_in(sectors),
             "load data came for a warp that loads nothing");
  add_data(now, token, sectors, ready);
}

void Sm::unblocked(Cycles now) {
  lsu_blocked_ = false;
  kick_lsu(now);
}

}  // namespace a2rt::timing
