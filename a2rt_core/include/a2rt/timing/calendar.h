// The calendar: who wakes when. A wheel of one bucket per cycle for the near future and a heap for
// the rest. Nothing is polled; a component that has nothing to do costs nothing.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/base/error.h"
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
  void at(Cycles when, Component& who, std::uint32_t what, std::uint32_t value = 0) {
    A2RT_CHECK(when >= now_, "an appointment was made in the past");
    ++pending_;
    if (when.value - now_.value < kWheel) [[likely]] {
      const std::size_t bucket = when.value % kWheel;
      place(bucket, {&who, what, value});
      occupied_[bucket / 64] |= std::uint64_t{1} << (bucket % 64);
    } else {
      push_far(when, {&who, what, value});
    }
  }

  // Moves to the next cycle that has appointments and keeps them all. Returns false if there are
  // none left.
  bool step();
  // Keeps all appointments before `end`.
  void run_before(Cycles end) {
    while (pending_ > 0 && next() < end) {
      step();
    }
  }
  // Cycle of the next appointment; there must be one.
  Cycles next() const;

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
  // Storage of kept buckets is used again for the next ones, so that it stays in the host's caches.
  void place(std::size_t index, Appointment appointment) {
    std::vector<Appointment>& bucket = buckets_[index];
    if (bucket.capacity() == 0 && !spare_.empty()) {
      bucket.swap(spare_.back());
      spare_.pop_back();
    }
    bucket.push_back(appointment);
  }
  void push_far(Cycles when, Appointment appointment);
  void pull_far();
  std::uint64_t distance_to_next_bucket() const;

  std::array<std::vector<Appointment>, kWheel> buckets_;
  std::vector<std::vector<Appointment>> spare_;
  std::array<std::uint64_t, kWheel / 64> occupied_{};
  std::vector<Far> far_;  // heap, earliest first
  std::uint64_t far_order_ = 0;
  std::uint64_t pending_ = 0;
  std::uint64_t served_ = 0;
  Cycles now_;
  Cycles last_progress_;
};

}  // namespace a2rt::timing
