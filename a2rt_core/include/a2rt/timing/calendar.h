// The calendar: who wakes when. A wheel of one bucket per cycle for the near future and a heap for
// the rest. Nothing is polled; a component that has nothing to do costs nothing.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/base/inline.h"
#include "a2rt/base/units.h"

namespace a2rt::timing {

// A part of the machine that the calendar can wake.
class Component {
 public:
  virtual ~Component() = default;
  // `what` and `value` are those the appointment was made with.
  virtual void wake(Cycles now, std::uint32_t what, std::uint32_t value) = 0;
  // One or more lines of state for the watchdog's report.
  virtual std::string dump() const = 0;
  // Throws InternalError if anything is still in flight; called when the machine is drained.
  virtual void check_drained() const = 0;
};

// Appointments of one cycle are kept in the order they were made, which makes runs repeatable.
class Calendar {
 public:
  Cycles now() const { return now_; }
  bool empty() const { return pending_ == 0; }
  std::uint64_t pending() const { return pending_; }
  std::uint64_t served() const { return served_; }

  // Throws InternalError if `when` has passed.
  A2RT_INLINE void at(Cycles when, Component& who, std::uint32_t what, std::uint32_t value = 0) {
    if (when.value - now_.value < kWheel) [[likely]] {  // neither far away nor in the past
      place(when.value % kWheel, {&who, what, value});
    } else {
      push_far(when, {&who, what, value});
    }
    ++pending_;
  }

  // Moves to the next cycle that has appointments and keeps them all. Returns false if there are
  // none left.
  bool step();
  // Keeps all appointments before end(), which is asked before each.
  template <class End>
  void run_before(const End& end) {
    while (pending_ > 0) {
      const Cycles at = next();
      if (at >= end()) {
        return;
      }
      serve(at);
    }
  }
  // Lets time pass to `when`; everything before it must have been kept.
  void move_to(Cycles when) {
    A2RT_CHECK(when >= now_ && (pending_ == 0 || next() >= when), "an appointment was passed over");
    now_ = when;
  }
  // Cycle of the next appointment; there must be one.
  Cycles next() const {
    std::uint64_t distance = 0;
    const std::uint64_t near =
        occupied_[now_.value % kWheel / 64] >> (now_.value % 64);  // rest of the present word
    if (near != 0) [[likely]] {
      distance = static_cast<std::uint64_t>(std::countr_zero(near));
    } else {
      distance = distance_to_next_bucket();
    }
    if (!far_.empty()) [[unlikely]] {
      distance = std::min(distance, far_.front().when.value - now_.value);
    }
    return now_ + Cycles{distance};
  }

  // Work was done; the watchdog counts from here.
  void progress() { last_progress_ = now_; }
  Cycles last_progress() const { return last_progress_; }

 private:
  static constexpr std::size_t kWheel = 1024;
  struct Appointment {
    Component* who;
    std::uint32_t what, value;
  };
  struct Far {
    Cycles when;
    std::uint64_t order;
    Appointment appointment;
  };
  static constexpr std::uint32_t kNil = 0xffffffffu;
  struct Node {
    Appointment appointment;
    std::uint32_t next = kNil;
  };
  struct Bucket {
    std::uint32_t first = kNil, last = kNil;
  };
  // Kept nodes are used again first, so that the pool's live part stays in the host's caches.
  A2RT_INLINE void place(std::size_t index, const Appointment& appointment) {
    if (free_ == kNil) [[unlikely]] {
      add_node();
    }
    const std::uint32_t node = free_;
    free_ = nodes_[node].next;
    nodes_[node] = {appointment, kNil};
    Bucket& bucket = buckets_[index];
    if (bucket.first == kNil) {
      bucket.first = node;
      occupied_[index / 64] |= std::uint64_t{1} << (index % 64);
    } else {
      nodes_[bucket.last].next = node;
    }
    bucket.last = node;
  }
  void add_node();
  void serve(Cycles at);
  void push_far(Cycles when, Appointment appointment);
  void pull_far();
  std::uint64_t distance_to_next_bucket() const;

  std::array<Bucket, kWheel> buckets_;
  std::vector<Node> nodes_;
  std::uint32_t free_ = kNil;
  std::array<std::uint64_t, kWheel / 64> occupied_{};
  std::vector<Far> far_;  // heap, earliest first
  std::uint64_t far_order_ = 0;
  std::uint64_t pending_ = 0;
  std::uint64_t served_ = 0;
  Cycles now_;
  Cycles last_progress_;
};

inline void Calendar::serve(Cycles at) {
  now_ = at;
  if (!far_.empty()) {
    pull_far();
  }
  const std::size_t index = now_.value % kWheel;
  // Appointments made for this very cycle while it runs are appended and kept too.
  std::uint64_t kept = 0;
  for (std::uint32_t node = buckets_[index].first; node != kNil; ++kept) {
    const Appointment appointment = nodes_[node].appointment;
    appointment.who->wake(at, appointment.what, appointment.value);
    const std::uint32_t next = nodes_[node].next;
    nodes_[node].next = free_;
    free_ = node;
    node = next;
  }
  served_ += kept;
  pending_ -= kept;
  buckets_[index] = {};
  occupied_[index / 64] &= ~(std::uint64_t{1} << (index % 64));
}

}  // namespace a2rt::timing
