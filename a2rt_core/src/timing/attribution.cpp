#include "a2rt/timing/attribution.h"

#include <algorithm>
#include <bit>

namespace a2rt::timing {

const char* reason_name(SchedulerReason reason) {
  static constexpr const char* kNames[] = {
      "issue_alu",   "issue_sfu", "issue_memory", "issue_trace",  "wait_dependency",
      "wait_memory", "wait_lsu",  "wait_rt_slot", "wait_rt_unit", "no_warp"};
  static_assert(std::size(kNames) == static_cast<std::size_t>(SchedulerReason::kCount));
  return kNames[static_cast<std::size_t>(reason)];
}

const char* reason_name(RtReason reason) {
  static constexpr const char* kNames[] = {"fetch",       "bank_busy",   "mshr_full", "test",
                                           "wait_memory", "wait_shader", "idle"};
  static_assert(std::size(kNames) == static_cast<std::size_t>(RtReason::kCount));
  return kNames[static_cast<std::size_t>(reason)];
}

const char* reason_name(LaneReason reason) {
  static constexpr const char* kNames[] = {"fetch", "test", "shader", "done", "inactive"};
  static_assert(std::size(kNames) == static_cast<std::size_t>(LaneReason::kCount));
  return kNames[static_cast<std::size_t>(reason)];
}

void BusyCycles::mark_any(std::uint64_t from, std::uint64_t to) {
  if (to > from && to > taken_.value + kWindow) {
    long_from_ = long_until_ >= Cycles{from} ? std::min(long_from_, Cycles{from}) : Cycles{from};
    long_until_ = std::max(long_until_, Cycles{to});
    return;
  }
  for (std::uint64_t at = from; at < to;) {
    const std::uint64_t n = std::min<std::uint64_t>(64, to - at);
    mark(Cycles{at}, Cycles{at + n});
    at += n;
  }
}

std::uint64_t BusyCycles::marked_in(std::uint64_t number) const {
  // Beyond the window nothing is marked but long intervals.
  const bool in_window = number * 64 < taken_.value + kWindow;
  std::uint64_t marked = in_window ? words_[number % words_.size()] : 0;
  const std::uint64_t from = std::max(long_from_.value, number * 64);
  const std::uint64_t until = std::min(long_until_.value, number * 64 + 64);
  if (until > from) [[unlikely]] {
    marked |= ~std::uint64_t{0} >> (64 - (until - from)) << from % 64;
  }
  return marked;
}

std::uint64_t BusyCycles::take_any(Cycles to, const BusyCycles* other) {
  std::uint64_t marked = 0;
  while (taken_ < to) {
    const std::uint64_t number = taken_.value / 64, bit = taken_.value % 64;
    const std::uint64_t n = std::min(64 - bit, to.value - taken_.value);
    const std::uint64_t mask = ~std::uint64_t{0} >> (64 - n) << bit;
    const std::uint64_t found =
        marked_in(number) & ~(other == nullptr ? 0 : other->marked_in(number)) & mask;
    marked += static_cast<std::uint64_t>(std::popcount(found));
    words_[number % words_.size()] &= ~mask;
    taken_ += Cycles{n};
  }
  return marked;
}

void BinnedSeries::add_across(Cycles from, Cycles to, std::uint64_t value) {
  while (to.value > sums_.size() << shift_) {
    for (std::size_t i = 0; i < sums_.size() / 2; ++i) {
      sums_[i] = sums_[2 * i] + sums_[2 * i + 1];
    }
    std::fill(sums_.begin() + static_cast<std::ptrdiff_t>(sums_.size() / 2), sums_.end(), 0);
    ++shift_;
  }
  std::uint64_t at = from.value;
  while (at < to.value) {
    const std::uint64_t bin = at >> shift_;
    const std::uint64_t stop = std::min(to.value, (bin + 1) << shift_);
    sums_[bin] += (stop - at) * value;
    at = stop;
  }
}

std::vector<double> BinnedSeries::means(Cycles end) const {
  std::vector<double> means;
  for (std::uint64_t bin = 0; bin << shift_ < end.value && bin < sums_.size(); ++bin) {
    const std::uint64_t cycles = std::min(width(), end.value - (bin << shift_));
    means.push_back(static_cast<double>(sums_[bin]) / static_cast<double>(cycles));
  }
  return means;
}

void PowerHistogram::add(std::uint64_t value) {
  const std::size_t bin = value == 0 ? 0 : static_cast<std::size_t>(std::bit_width(value) - 1);
  ++bins_[std::min(bin, bins_.size() - 1)];
  ++count_;
  sum_ += value;
  largest_ = std::max(largest_, value);
}

}  // namespace a2rt::timing
