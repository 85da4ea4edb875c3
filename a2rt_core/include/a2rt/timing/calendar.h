// The calendar: who wakes when. A wheel of one bucket per cycle for the near future and a heap for
// the rest. Nothing is polled; a component that has nothing to do costs nothing.
//
// A machine has a calendar per SM and two more, which take turns in the host's caches: a bucket is
// four bytes and an appointment sixteen.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>
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

// Appointments of one cycle are kept in the order they were made, numbers before all others, which
// makes runs repeatable.
class Calendar {
 public:
  static constexpr Cycles kNever{~std::uint64_t{0}};

  Calendar() { buckets_.fill(kNil); }
  Cycles now() const { return now_; }
  bool empty() const { return next() == kNever; }
  // Appointments so far; once the calendar is empty, all of them have been kept.
  std::uint64_t made() const { return made_; }

  // `what` is below 256. Throws InternalError if `when` has passed.
  A2RT_INLINE void at(Cycles when, Component& who, std::uint32_t what, std::uint32_t value = 0) {
    A2RT_CHECK(what < 1u << kWhatBits, "an appointment's reason does not fit");
    if (when.value - now_.value < kWheel) [[likely]] {  // neither far away nor in the past
      place(when.value % kWheel, &who, what, value);
    } else {
      push_far(when, &who, what, value);
    }
    ++made_;
  }

  // Lets `who` appoint numbers below `count`, which costs the host less: each of them has at most
  // one appointment at a time, always later than the present cycle. In a cycle they come first. One
  // that is far away is also a promise().
  void number(Component& who, std::uint32_t what, std::uint32_t count);
  A2RT_INLINE void at(Cycles when, std::uint32_t number) {
    A2RT_CHECK(when > now_, "a number was appointed for the present or the past");
    if (when.value - now_.value < kWheel) [[likely]] {
      place_number(when.value % kWheel, static_cast<std::uint16_t>(number));
    } else {
      promise(when);
      push_far(when, numbered_, numbered_what_, number);
    }
    ++made_;
  }

  // Moves to the next cycle that has appointments and keeps them all. Returns false if there are
  // none left.
  bool step();
  // Keeps all appointments before end(), which is asked before each.
  template <class End>
  void run_before(const End& end) {
    for (Cycles at = next(); at < end(); at = next()) {
      serve(at);
    }
  }
  // Lets time pass to `when`; everything before it must have been kept.
  void move_to(Cycles when) {
    A2RT_CHECK(when >= now_ && next() >= when, "an appointment was passed over");
    now_ = when;
    pull_far();
  }
  // Cycle of the next appointment, or kNever; at most a turn of the wheel ahead, where a far one is
  // looked for again.
  Cycles next() const {
    const std::uint64_t near =
        occupied_[now_.value % kWheel / 64] >> (now_.value % 64);  // rest of the present word
    if (near != 0) [[likely]] {
      return now_ + Cycles{static_cast<std::uint64_t>(std::countr_zero(near))};
    }
    return next_in_other_words();
  }

  // Work was done; the watchdog counts from here.
  void progress() { last_progress_ = now_; }
  // Something will certainly be there in cycle `when`; until then nobody need show progress.
  void promise(Cycles when) { promised_ = std::max(promised_, when); }
  Cycles last_progress() const { return std::max(last_progress_, promised_); }

 private:
  static constexpr std::size_t kWheel = 1024;
  static constexpr std::uint32_t kWhatBits = 8;
  static constexpr std::uint32_t kNil = 0xffffffffu >> kWhatBits;  // also the most there can be
  struct Appointment {
    Component* who = nullptr;
    std::uint32_t value = 0;
    std::uint32_t link = 0;  // the next one's place, and `what` in the low bits
    std::uint32_t what() const { return link & ((1u << kWhatBits) - 1); }
    std::uint32_t next() const { return link >> kWhatBits; }
    void set_next(std::uint32_t place) { link = place << kWhatBits | what(); }
  };
  struct Far {
    Cycles when;
    std::uint64_t order;
    Component* who;
    std::uint32_t what, value;
  };
  // A bucket's appointments form a ring, of which the bucket knows the last.
  A2RT_INLINE void place(std::size_t index, Component* who, std::uint32_t what,
                         std::uint32_t value) {
    if (free_ == kNil) [[unlikely]] {
      add_place();
    }
    const std::uint32_t place = free_;
    Appointment& made = appointments_[place];
    free_ = made.next();
    made = {who, value, place << kWhatBits | what};
    // The first of a bucket is its own predecessor, so both cases take the same steps; a branch
    // here would be a toss-up.
    const std::uint32_t before = buckets_[index];
    const std::uint32_t some = -static_cast<std::uint32_t>(before != kNil);
    Appointment& last = appointments_[place ^ ((place ^ before) & some)];
    made.set_next(last.next());
    last.set_next(place);
    buckets_[index] = place;
    occupied_[index / 64] |= std::uint64_t{1} << (index % 64);
  }
  A2RT_INLINE void place_number(std::size_t index, std::uint16_t number) {
    const std::uint16_t before = numbers_[index];
    // The first of a cycle is its own successor.
    next_number_[number] = number;
    const std::uint16_t last = before == kNoNumber ? number : before;
    next_number_[number] = next_number_[last];
    next_number_[last] = number;
    numbers_[index] = number;
    occupied_[index / 64] |= std::uint64_t{1} << (index % 64);
  }
  void add_place();
  void serve(Cycles at);
  void serve_numbers(Cycles at, std::uint16_t last);
  void push_far(Cycles when, Component* who, std::uint32_t what, std::uint32_t value);
  void pull_far();
  Cycles next_in_other_words() const;

  std::vector<Appointment> appointments_;
  std::uint32_t free_ = kNil;  // those kept last are used again first, while the host has them near
  std::uint64_t made_ = 0;
  Cycles now_;
  Cycles last_progress_, promised_;
  std::array<std::uint64_t, kWheel / 64> occupied_{};
  std::array<std::uint32_t, kWheel> buckets_;  // the last of a ring, or kNil
  // Numbers of a cycle form a ring, too.
  static constexpr std::uint16_t kNoNumber = 0xffff;
  Component* numbered_ = nullptr;
  std::uint32_t numbered_what_ = 0;
  std::vector<std::uint16_t> numbers_;      // the last of a ring; empty if nobody has numbers
  std::vector<std::uint16_t> next_number_;  // by number
  std::vector<Far> far_;                    // heap, earliest first
};

inline void Calendar::serve(Cycles at) {
  now_ = at;
  const std::size_t index = at.value % kWheel;
  if (!far_.empty()) [[unlikely]] {
    pull_far();
    if ((occupied_[index / 64] >> (index % 64) & 1) == 0) {
      return;  // the far ones are farther than a turn
    }
  }
  if (numbered_ != nullptr) {
    serve_numbers(at, std::exchange(numbers_[index], kNoNumber));
  }
  const std::uint32_t& last = buckets_[index];
  if (last != kNil) {
    // Appointments made for this very cycle while it runs are appended and kept too.
    std::uint32_t place = last;
    do {
      place = appointments_[place].next();
      const Appointment kept = appointments_[place];
      kept.who->wake(at, kept.what(), kept.value);
    } while (place != last);
    // The whole ring becomes free at once.
    const std::uint32_t first = appointments_[place].next();
    appointments_[place].set_next(free_);
    free_ = first;
    buckets_[index] = kNil;
  }
  occupied_[index / 64] &= ~(std::uint64_t{1} << (index % 64));
}

A2RT_INLINE void Calendar::serve_numbers(Cycles at, std::uint16_t last) {
  if (last == kNoNumber) {
    return;
  }
  std::uint16_t number = next_number_[last];
  while (true) {
    const std::uint16_t next = next_number_[number];
    numbered_->wake(at, numbered_what_, number);
    if (number == last) {
      return;
    }
    number = next;
  }
}

}  // namespace a2rt::timing
