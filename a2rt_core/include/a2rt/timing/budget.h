// Bandwidths as types: ports and banks. A port's uses go out in order, at most `limit` in a cycle
// of its clock. A model that would send more than its hardware could stops with an error instead of
// printing a nicer figure.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

#include "a2rt/base/bits.h"
#include "a2rt/base/error.h"
#include "a2rt/base/inline.h"
#include "a2rt/base/units.h"
#include "a2rt/timing/clock.h"
#include "a2rt/timing/sectors.h"
#include "a2rt/timing/wrap.h"

namespace a2rt::timing {

class Port {
 public:
  // `limit` uses per cycle of `clock`.
  explicit Port(std::uint32_t limit, ClockDomain clock = {})
      : limit_(limit), same_clock_(clock.same()), clock_(clock) {
    A2RT_CHECK(limit > 0, "a port of 0 uses per cycle would never let anything pass");
  }

  // Core cycle of the next use, if it is wanted at `now` or later.
  Cycles next(Cycles now) const {
    return now <= free_ ? free_ : same_clock_ ? now : clock_.to_core(clock_.seen_from(now));
  }
  // So many uses may go through in one core cycle: `at`, which is next() of some cycle, or a later.
  bool fits(Cycles at, std::uint32_t uses) const {
    return same_clock_ && uses <= (at >= following_ ? limit_ : limit_ - used_);
  }
  // Uses the port in core cycle `at`, an edge of its clock. Throws InternalError if more than the
  // limit goes through in one cycle, or if time runs backwards.
  void use(Cycles at, std::uint32_t uses = 1) {
    if (at >= following_) {
      end_ = at + Cycles{1};
      following_ =
          same_clock_ ? end_ : std::max(end_, clock_.to_core(clock_.seen_from(at) + Cycles{1}));
      used_ = 0;
      ++cycles_used_;
    }
    used_ += uses;
    A2RT_CHECK(at + Cycles{1} == end_,
               "a port was used in the past or between cycles of its clock");
    A2RT_CHECK(used_ <= limit_, "a port's bandwidth was overspent");
    free_ = used_ < limit_ ? at : following_;
  }
  // A port that lets one use through in every core cycle.
  bool simple() const { return limit_ == 1 && same_clock_; }
  // Uses a simple port in so many cycles from `first` on.
  void use_in_turn(Cycles first, std::uint32_t uses) {
    A2RT_CHECK(first >= following_, "a port was used in the past");
    free_ = following_ = end_ = first + Cycles{uses};
    used_ = 1;
    cycles_used_ += uses;
  }
  // Sends so many uses in the first cycles with room from `now` on.
  struct Sent {
    Cycles first, last;
  };
  A2RT_INLINE Sent send(Cycles now, std::uint32_t uses) {
    const Cycles first = next(now);
    if (simple()) [[likely]] {
      use_in_turn(first, uses);
      return {first, first + Cycles{uses - 1}};
    }
    Cycles last = first;
    use(first);
    for (std::uint32_t i = 1; i < uses; ++i) {
      last = next(now);
      use(last);
    }
    return {first, last};
  }
  // Cycles of its clock in which anything went through.
  std::uint64_t cycles_used() const { return cycles_used_; }
  // First core cycle after the last use.
  Cycles end() const { return end_; }

 private:
  std::uint32_t limit_;
  std::uint32_t used_ = 0;
  bool same_clock_;
  Cycles free_;  // with room for another use
  Cycles end_, following_;
  std::uint64_t cycles_used_ = 0;
  ClockDomain clock_;
};

// In which cycles the sectors of a message go through their banks, when nothing is in their way.
struct alignas(64) Passage {
  std::array<std::uint64_t, kSectorsPerLine> after{};   // the first
  std::array<std::uint64_t, kSectorsPerLine> cycles{};  // bit i: in the i-th cycle
  // Each of a message's sectors in a cycle of its own, and all in one.
  static constexpr std::array<Passage, 1u << kSectorsPerLine> in_turn();
  static constexpr std::array<Passage, 1u << kSectorsPerLine> together();
};

constexpr std::array<Passage, 1u << kSectorsPerLine> Passage::in_turn() {
  std::array<Passage, 1u << kSectorsPerLine> all{};
  for (std::uint32_t sectors = 0; sectors < all.size(); ++sectors) {
    std::uint64_t position = 0;
    for_each_bit(sectors, [&](std::uint32_t s) {
      all[sectors].after[s] = position;
      all[sectors].cycles[s] = std::uint64_t{1} << position++;
    });
  }
  return all;
}

constexpr std::array<Passage, 1u << kSectorsPerLine> Passage::together() {
  std::array<Passage, 1u << kSectorsPerLine> all{};
  for (std::uint32_t sectors = 0; sectors < all.size(); ++sectors) {
    for_each_bit(sectors, [&](std::uint32_t s) { all[sectors].cycles[s] = 1; });
  }
  return all;
}

inline constexpr auto kInTurn = Passage::in_turn();
inline constexpr auto kTogether = Passage::together();

// The banks of a cache: one access per cycle each, reserved up to kReach cycles ahead.
class Banks {
 public:
  explicit Banks(std::uint32_t count)
      : groups_((count + kSectorsPerLine - 1) / kSectorsPerLine),
        wrap_(count),
        group_mask_(groups_.size() - 1),
        line_reach_(count % kSectorsPerLine == 0 && std::has_single_bit(count)
                        ? kReach - kSectorsPerLine
                        : 0) {
    A2RT_CHECK(count > 0, "a cache has at least one bank");
  }
  // Time has come to `now`; it only moves forward.
  void advance(Cycles now) {
    const std::uint64_t by = std::min(now.value - base_.value, kReach);
    base_ = now;
    for (Group& group : groups_) {
      for (std::uint64_t& taken : group) {
        taken >>= by;
      }
    }
  }
  std::size_t of(std::uint64_t sector) const { return wrap_.of(sector); }
  // Sends the sectors of a line from `wanted` on in the order of `passage`, which only the first of
  // them delays; returns when that passes. None is sent if another one finds its bank taken, or if
  // the line's sectors do not fall on banks of their own.
  A2RT_INLINE std::optional<Cycles> take_all(std::uint64_t line, SectorMask sectors, Cycles wanted,
                                             const Passage& passage) {
    std::uint64_t ahead = wanted.value - base_.value;
    if (ahead >= line_reach_) [[unlikely]] {
      return std::nullopt;
    }
    Group& group = groups_[line & group_mask_];
    const auto first = static_cast<std::size_t>(std::countr_zero(sectors));
    const auto wait = static_cast<std::uint64_t>(std::countr_one(group[first] >> ahead));
    ahead += wait;
    std::uint64_t clash = 0;
    for (std::size_t i = 0; i < group.size(); ++i) {
      clash |= group[i] & passage.cycles[i] << ahead;
    }
    if (clash != 0 || ahead >= line_reach_) [[unlikely]] {
      return std::nullopt;
    }
    for (std::size_t i = 0; i < group.size(); ++i) {
      group[i] |= passage.cycles[i] << ahead;
    }
    return base_ + Cycles{ahead};
  }
  // First cycle from `at` on in which the bank is free. Throws InternalError if it is too far away.
  Cycles free_from(std::size_t bank, Cycles at) const {
    const std::uint64_t ahead = at.value - base_.value;
    const std::uint64_t open = ahead < kReach ? ~taken(bank) >> ahead : 0;
    A2RT_CHECK(open != 0, "a bank was asked about a cycle it does not hold");
    return at + Cycles{static_cast<std::uint64_t>(std::countr_zero(open))};
  }
  // Reserves a cycle that is free.
  void take(std::size_t bank, Cycles at) {
    const std::uint64_t ahead = at.value - base_.value;
    A2RT_CHECK(ahead < kReach && (taken(bank) >> ahead & 1) == 0, "a bank's cycle is not free");
    taken(bank) |= std::uint64_t{1} << ahead;
  }

 private:
  // Bits of a word of cycles: one less, so that all of them can be shifted out at once.
  static constexpr std::uint64_t kReach = 63;
  // Of as many banks as a line has sectors; bit i: cycle base_ + i.
  using Group = std::array<std::uint64_t, kSectorsPerLine>;
  const std::uint64_t& taken(std::size_t bank) const {
    return groups_[bank / kSectorsPerLine][bank % kSectorsPerLine];
  }
  std::uint64_t& taken(std::size_t bank) {
    return groups_[bank / kSectorsPerLine][bank % kSectorsPerLine];
  }

  std::vector<Group> groups_;
  Wrap wrap_;
  std::uint64_t group_mask_;
  std::uint64_t line_reach_;  // how far ahead whole lines can be reserved
  Cycles base_;
};

}  // namespace a2rt::timing
