// Lines of which data is on its way and whose arrival is known, for the model that reserves every
// message's way ahead: who asks meanwhile waits for the same data.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/base/inline.h"
#include "a2rt/base/units.h"
#include "a2rt/timing/sectors.h"

namespace a2rt::timing {

// A table of two lines a bucket. What does not fit and is still on its way goes to a map beside it,
// which is mostly empty.
class ComingLines {
 public:
  // Room for so many lines, a power of two from 4 on.
  explicit ComingLines(std::size_t lines)
      : buckets_(lines / kWays),
        shift_(static_cast<std::uint32_t>(std::countl_zero(buckets_.size())) + 1) {
    A2RT_CHECK(std::has_single_bit(lines) && lines >= 2 * kWays,
               "a table has a power of two lines");
  }

  class Line {
   public:
    // Those on their way at `now`, of the ones asked for.
    SectorMask coming(Cycles now, SectorMask sectors) const {
      return there_ > now ? static_cast<SectorMask>(number_and_sectors_ & sectors) : SectorMask{0};
    }
    // When the last of those on their way is there.
    Cycles there() const { return there_; }
    // These come, too.
    void add(Cycles now, SectorMask sectors, Cycles there) {
      const bool more = there_ > now;
      number_and_sectors_ = (more ? number_and_sectors_ : number_and_sectors_ & ~kAll) | sectors;
      there_ = more ? std::max(there_, there) : there;
    }

   private:
    friend class ComingLines;
    static constexpr std::uint64_t kAll = (std::uint64_t{1} << kSectorsPerLine) - 1;
    bool is(std::uint64_t number) const { return number_and_sectors_ >> kSectorsPerLine == number; }
    std::uint64_t number_and_sectors_ = ~kAll;  // no line
    Cycles there_;
  };

  void prefetch(std::uint64_t number) const { __builtin_prefetch(&buckets_[place(number)], 1); }
  // The line numbered so (below 2^59), if anything is known of it.
  A2RT_INLINE const Line* find(std::uint64_t number) const {
    const Bucket& bucket = buckets_[place(number)];
    return bucket[0].is(number)   ? &bucket[0]
           : bucket[1].is(number) ? &bucket[1]
           : beside_.empty()      ? nullptr
                                  : find_beside(number);
  }
  // The same; if nothing is, its place. Until the next call.
  A2RT_INLINE Line& obtain(Cycles now, std::uint64_t number) {
    Bucket& bucket = buckets_[place(number)];
    const bool second =
        bucket[1].is(number) || (!bucket[0].is(number) && bucket[1].there_ < bucket[0].there_);
    Line& line = bucket[second];
    if (!line.is(number) && (line.there_ > now || !beside_.empty())) [[unlikely]] {
      return make_room(now, line, number);
    }
    // Another line's time says nothing about this one's.
    line.there_ = line.is(number) ? line.there_ : Cycles{0};
    line.number_and_sectors_ = number << kSectorsPerLine | (line.number_and_sectors_ & Line::kAll);
    return line;
  }

 private:
  static constexpr std::size_t kWays = 2;
  using Bucket = std::array<Line, kWays>;
  std::size_t place(std::uint64_t line) const { return mixed(line) >> shift_; }
  const Line* find_beside(std::uint64_t number) const {
    const auto found = beside_.find(number);
    return found == beside_.end() ? nullptr : &found->second;
  }
  // Puts what is in the line's place aside if it is still on its way, and the line there.
  A2RT_NOINLINE Line& make_room(Cycles now, Line& line, std::uint64_t number) {
    Line wanted;
    wanted.number_and_sectors_ = number << kSectorsPerLine;
    if (const auto found = beside_.find(number); found != beside_.end()) {
      wanted = found->second;
      beside_.erase(found);
    }
    if (line.there_ > now) {
      if (beside_.size() >= most_beside_) {
        std::erase_if(beside_, [&](const auto& entry) { return entry.second.there_ <= now; });
        most_beside_ = std::max(kLeastBeside, beside_.size() * 2);
      }
      beside_[line.number_and_sectors_ >> kSectorsPerLine] = line;
    }
    line = wanted;
    return line;
  }

  static constexpr std::size_t kLeastBeside = 64;
  std::vector<Bucket> buckets_;
  std::uint32_t shift_;
  std::unordered_map<std::uint64_t, Line> beside_;
  std::size_t most_beside_ = kLeastBeside;
};

}  // namespace a2rt::timing
