// Where the cycles went: every cycle of a thing is booked under exactly one reason.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/base/inline.h"
#include "a2rt/base/units.h"

namespace a2rt::timing {

// Reason is an enum class ending in kCount. Time up to `until_` is booked; the rest is not yet.
template <class Reason>
class Attribution {
 public:
  // Books the cycles from the last booked one to `now` under `reason`.
  void until(Cycles now, Reason reason) {
    if (now > until_) {
      cycles_[static_cast<std::size_t>(reason)] += now.value - until_.value;
      until_ = now;
    }
  }
  // The same, of which `part` cycles go under `first`.
  void until(Cycles now, std::uint64_t part, Reason first, Reason rest) {
    if (now > until_) {
      A2RT_CHECK(part <= now.value - until_.value, "more cycles are booked than have passed");
      cycles_[static_cast<std::size_t>(first)] += part;
      cycles_[static_cast<std::size_t>(rest)] += now.value - until_.value - part;
      until_ = now;
    }
  }
  Cycles booked() const { return until_; }
  const auto& cycles() const { return cycles_; }
  // Throws InternalError unless every cycle before `end` is booked once.
  void check(Cycles end) const {
    std::uint64_t sum = 0;
    for (const std::uint64_t c : cycles_) {
      sum += c;
    }
    A2RT_CHECK(sum == end.value && until_ == end, "attributed cycles do not add up to the run");
  }

 private:
  std::array<std::uint64_t, static_cast<std::size_t>(Reason::kCount)> cycles_{};
  Cycles until_;
};

// In which cycles anything of a kind was under way: the union of intervals that start in the near
// future and may come in any order.
class BusyCycles {
 public:
  // Adds the cycles [from, to). What take() has already passed is ignored.
  A2RT_INLINE void mark(Cycles from, Cycles to) {
    const std::uint64_t at = std::max(from, taken_).value, n = to.value - at;
    if (n - 1 >= 64 || to.value > taken_.value + kWindow) [[unlikely]] {
      mark_any(at, to.value);
      return;
    }
    const std::uint64_t marks = ~std::uint64_t{0} >> (64 - n), bit = at % 64;
    words_[at / 64 % words_.size()] |= marks << bit;
    // Mostly nothing; a branch would be taken now and then.
    words_[(at / 64 + 1) % words_.size()] |= marks >> 1 >> (63 - bit);
  }
  // Cycles marked in [end of the last call, to).
  A2RT_INLINE std::uint64_t take(Cycles to) {
    const std::uint64_t bit = taken_.value % 64, n = to.value - taken_.value;
    if (n - 1 >= 64 - bit || long_until_ > taken_) [[unlikely]] {
      return take_any(to);
    }
    std::uint64_t& word = words_[taken_.value / 64 % words_.size()];
    const std::uint64_t marked = word & ~std::uint64_t{0} >> (64 - n) << bit;
    word &= ~marked;
    taken_ = to;
    return static_cast<std::uint64_t>(std::popcount(marked));
  }

  // The same, without those that `other` has marked, too. To be called before other.take(to).
  std::uint64_t take_without(Cycles to, const BusyCycles& other) { return take_any(to, &other); }

 private:
  static constexpr std::uint64_t kWindow = 4096 - 64;
  // Any number of cycles, without those of `other`, if there is one.
  std::uint64_t take_any(Cycles to, const BusyCycles* other = nullptr);
  // Bit i: cycle 64 `number` + i is marked.
  std::uint64_t marked_in(std::uint64_t number) const;
  void mark_any(std::uint64_t from, std::uint64_t to);
  std::array<std::uint64_t, 64> words_{};
  Cycles taken_;
  Cycles long_from_, long_until_;  // hull of the intervals that outlast the window
};

// What one scheduler of an SM did in a cycle.
enum class SchedulerReason : std::uint8_t {
  kIssueAlu,
  kIssueSfu,
  kIssueMemory,
  kIssueTrace,
  kWaitDependency,  // a warp waits for its own ALU or SFU result
  kWaitMemory,      // for loads
  kWaitLsu,         // for room in the load/store queue
  kWaitRtSlot,      // for a place in the RT unit's warp buffer
  kWaitRtUnit,      // warps are being traced
  kNoWarp,
  kCount
};
const char* reason_name(SchedulerReason reason);

// What an RT unit did in a cycle.
enum class RtReason : std::uint8_t {
  kFetch,       // the L1 port sent a request
  kBankBusy,    // its request was turned away by an L1 bank
  kMshrFull,    // by the L1's MSHRs
  kTest,        // no request to send, testers at work
  kWaitMemory,  // no test under way, data awaited
  kWaitShader,  // candidates are being judged on the SM
  kIdle,        // no warp
  kCount
};
const char* reason_name(RtReason reason);

// What the lanes of resident warps did, in lane-cycles.
enum class LaneReason : std::uint8_t {
  kFetch,     // waiting for its sectors, port included
  kTest,      // in a tester or waiting for one
  kShader,    // candidate away on the SM
  kDone,      // waiting for the other rays of the warp
  kInactive,  // lane without a ray
  kCount
};
const char* reason_name(LaneReason reason);

// A quantity summed over time in bins whose width doubles whenever the run outgrows them.
class BinnedSeries {
 public:
  explicit BinnedSeries(std::size_t bins = 256) : sums_(bins, 0) {}
  // Adds `value` for each cycle in [from, to).
  void add(Cycles from, Cycles to, std::uint64_t value) {
    const std::uint64_t bin = from.value >> shift_;
    if (to.value <= (bin + 1) << shift_ && bin < sums_.size()) [[likely]] {
      sums_[bin] += (to.value - from.value) * value;
    } else {
      add_across(from, to, value);
    }
  }
  std::uint64_t width() const { return std::uint64_t{1} << shift_; }
  // Means per bin up to `end`; the last bin may be partial.
  std::vector<double> means(Cycles end) const;

 private:
  void add_across(Cycles from, Cycles to, std::uint64_t value);
  std::vector<std::uint64_t> sums_;
  std::uint32_t shift_ = 6;
};

// Counts in bins of powers of two: bin b holds values in [2^b, 2^(b+1)), bin 0 also 0.
class PowerHistogram {
 public:
  void add(std::uint64_t value);
  const std::array<std::uint64_t, 40>& bins() const { return bins_; }
  std::uint64_t count() const { return count_; }
  std::uint64_t sum() const { return sum_; }
  std::uint64_t largest() const { return largest_; }

 private:
  std::array<std::uint64_t, 40> bins_{};
  std::uint64_t count_ = 0, sum_ = 0, largest_ = 0;
};

}  // namespace a2rt::timing
