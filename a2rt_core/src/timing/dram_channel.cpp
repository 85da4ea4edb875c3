#include "a2rt/timing/dram_channel.h"

#include <algorithm>
#include <limits>

namespace a2rt::timing {
namespace {

constexpr Cycles kNever{std::numeric_limits<std::uint64_t>::max()};

}  // namespace

DramChannel::DramChannel(const DramConfig& config, std::uint64_t core_mhz, Calendar& calendar,
                         Client& client)
    : config_(config),
      calendar_(calendar),
      client_(client),
      clock_(config.mhz, core_mhz),
      row_bytes_(config.row.value),
      bank_count_(config.banks),
      banks_(config.banks) {}

void DramChannel::enqueue(Cycles now, std::uint64_t local, bool write, std::uint32_t tag) {
  std::uint32_t index = free_;
  if (index == kNil) {
    index = static_cast<std::uint32_t>(requests_.size());
    requests_.push_back({});
  } else {
    free_ = requests_[index].next;
  }
  const auto [row, bank] = bank_count_.divide(row_bytes_.quotient(local));
  requests_[index] = {row,  order_++, tag,   static_cast<std::uint32_t>(bank),
                      kNil, write,    false, false};
  ++(write ? counts_.writes : counts_.reads);
  if (queued_ < config_.queue) {
    place(index);
  } else {
    (waiting_first_ == kNil ? waiting_first_ : requests_[waiting_last_].next) = index;
    waiting_last_ = index;
    ++waiting_;
  }
  book(clock_.from_core(now));
}

void DramChannel::place(std::uint32_t index) {
  const std::uint32_t number = requests_[index].bank;
  Bank& bank = banks_[number];
  if (bank.first == kNil) {
    bank.first = index;
    bank.place = static_cast<std::uint32_t>(busy_.size());
    busy_.push_back(number);
  } else {
    requests_[bank.last].next = index;
  }
  bank.last = index;
  requests_[index].next = kNil;
  bank.hits += bank.open && bank.row == requests_[index].row;
  ++queued_;
}

// Takes a request out of its bank's queue, where it is behind `before`.
void DramChannel::remove(std::uint32_t index, std::uint32_t before) {
  const Request& request = requests_[index];
  Bank& bank = banks_[request.bank];
  (before == kNil ? bank.first : requests_[before].next) = request.next;
  if (bank.last == index) {
    bank.last = before;
  }
  if (bank.first == kNil) {
    busy_[bank.place] = busy_.back();
    banks_[busy_.back()].place = bank.place;
    busy_.pop_back();
  }
  --bank.hits;
  --queued_;
}

void DramChannel::book(Cycles own) {
  const Cycles when = std::max(calendar_.now(), clock_.core_of(own));
  if (booked_ && booked_at_ <= when) {
    return;
  }
  booked_ = true;
  booked_at_ = when;
  calendar_.at(when, *this, kSchedule);
}

void DramChannel::wake(Cycles now, std::uint32_t what, std::uint32_t value) {
  calendar_.progress();
  if (what == kData) {
    --in_flight_;
    client_.dram_done(now, value);
    return;
  }
  if (!booked_ || booked_at_ != now) {
    return;  // an earlier booking replaced this one
  }
  booked_ = false;
  // One core cycle can hold several command cycles: all those before the next core edge.
  const Cycles end = clock_.from_core(now + Cycles{1});
  Cycles own = clock_.from_core(now);
  while (own < end && queued_ > 0) {
    schedule(own);
    const Cycles next = next_chance(own);
    own = std::max(own + Cycles{1}, next);
  }
  if (queued_ > 0) {
    book(own);
  }
}

void DramChannel::schedule(Cycles own) {
  issue_column(own);
  prepare_row(own);
}

Cycles DramChannel::row_start(const Bank& bank) const {
  const Cycles ready =
      bank.open ? bank.precharge_ready : std::max(bank.activate_ready, activate_ready_);
  return std::max(ready, row_command_ready_);
}

// Earliest command cycle after `own` at which some command could go out.
Cycles DramChannel::next_chance(Cycles own) const {
  Cycles best = kNever;
  for (const std::uint32_t b : busy_) {
    const Bank& bank = banks_[b];
    best =
        std::min(best, bank.hits > 0 ? std::max(bank.column_ready, bus_ready_) : row_start(bank));
  }
  return std::max(best, own + Cycles{1});
}

void DramChannel::issue_column(Cycles own) {
  std::uint32_t chosen = kNil, before_chosen = kNil;
  for (const std::uint32_t b : busy_) {
    const Bank& bank = banks_[b];
    if (bank.hits == 0 || bank.column_ready > own) {
      continue;
    }
    std::uint32_t before = kNil, index = bank.first;
    while (requests_[index].row != bank.row) {
      before = index;
      index = requests_[index].next;
    }
    if (chosen == kNil || requests_[index].order < requests_[chosen].order) {
      chosen = index;
      before_chosen = before;
    }
  }
  if (chosen == kNil) {
    return;
  }
  Request& request = requests_[chosen];
  const bool turns = request.write != last_was_write_ && bus_ready_ > Cycles{0};
  if (own < (turns ? bus_ready_ + config_.turnaround : bus_ready_)) {
    return;
  }
  last_was_write_ = request.write;
  bus_ready_ = own + std::max(config_.ccd, config_.burst);
  counts_.busy_cycles += config_.burst.value;
  ++(request.needed_precharge  ? counts_.row_conflicts
     : request.needed_activate ? counts_.row_misses
                               : counts_.row_hits);
  Bank& bank = banks_[request.bank];
  const Cycles data = own + (request.write ? config_.wl : config_.cl) + config_.burst;
  bank.precharge_ready =
      std::max(bank.precharge_ready, request.write ? data + config_.wr : own + config_.rtp);
  remove(chosen, before_chosen);
  if (!request.write) {
    ++in_flight_;
    calendar_.at(clock_.to_core(data), *this, kData, request.tag);
  }
  request.next = free_;
  free_ = chosen;
  if (waiting_first_ != kNil) {
    const std::uint32_t next = waiting_first_;
    waiting_first_ = requests_[next].next;
    --waiting_;
    place(next);
  }
}

void DramChannel::prepare_row(Cycles own) {
  Bank* chosen = nullptr;
  for (const std::uint32_t b : busy_) {
    Bank& bank = banks_[b];
    if (bank.hits == 0 && row_start(bank) <= own &&
        (chosen == nullptr || requests_[bank.first].order < requests_[chosen->first].order)) {
      chosen = &bank;
    }
  }
  if (chosen == nullptr) {
    return;
  }
  row_command_ready_ = own + Cycles{1};
  Request& request = requests_[chosen->first];
  if (chosen->open) {
    chosen->open = false;
    chosen->activate_ready = std::max(chosen->activate_ready, own + config_.rp);
    request.needed_precharge = true;
    return;
  }
  chosen->open = true;
  chosen->row = request.row;
  request.needed_activate = true;
  chosen->column_ready = own + config_.rcd;
  chosen->precharge_ready = own + config_.ras;
  chosen->activate_ready = own + config_.rc;
  activate_ready_ = own + config_.rrd;
  ++counts_.activates;
  for (std::uint32_t i = chosen->first; i != kNil; i = requests_[i].next) {
    chosen->hits += requests_[i].row == chosen->row;
  }
}

std::string DramChannel::dump() const {
  return "dram: " + std::to_string(queued_) + " queued, " + std::to_string(waiting_) +
         " beyond the window, " + std::to_string(in_flight_) + " on the bus\n";
}

void DramChannel::check_drained() const {
  A2RT_CHECK(queued_ == 0 && waiting_ == 0 && in_flight_ == 0,
             "DRAM requests were never served: " + dump());
  A2RT_CHECK(counts_.row_hits + counts_.row_misses + counts_.row_conflicts ==
                 counts_.reads + counts_.writes,
             "DRAM row outcomes differ from requests");
}

}  // namespace a2rt::timing
