// When sectors of a line that were asked for will be there, for the model that reserves every
// message's way ahead.
#pragma once

#include <algorithm>
#include <cstdint>

#include "a2rt/base/units.h"
#include "a2rt/timing/sectors.h"

namespace a2rt::timing {

// Sectors of one line on their way to one receiver, who gets all of them in the same cycle (below
// 2^54). Of several receivers only the last is known.
class Arrival {
 public:
  static constexpr std::uint32_t kReceivers = 64;

  // What of it is still on its way to the receiver at `now`; nothing has a time of 0.
  Arrival after(Cycles now, std::uint32_t receiver) const {
    const bool later = there() > now, same = (bits_ >> kReceiverShift) % kReceivers == receiver;
    // A branch would be a toss-up.
    return Arrival(bits_ & -static_cast<std::uint64_t>(later & same));
  }
  SectorMask sectors() const { return static_cast<SectorMask>(bits_ & kSectors); }
  Cycles there() const { return Cycles{bits_ >> kTimeShift}; }
  // With sectors to this receiver, too.
  Arrival with(std::uint32_t receiver, SectorMask sectors, Cycles there) const {
    const std::uint64_t last = std::max(bits_ >> kTimeShift, there.value);
    return Arrival(last << kTimeShift | receiver << kReceiverShift | (bits_ & kSectors) | sectors);
  }

  Arrival() = default;

 private:
  static constexpr std::uint32_t kReceiverShift = kSectorsPerLine, kTimeShift = 10;
  static constexpr std::uint64_t kSectors = (1u << kSectorsPerLine) - 1;
  static_assert(kReceivers << kReceiverShift == 1u << kTimeShift);
  explicit Arrival(std::uint64_t bits) : bits_(bits) {}
  std::uint64_t bits_ = 0;
};

}  // namespace a2rt::timing
