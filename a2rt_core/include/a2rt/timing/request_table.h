// The outstanding fetches of one warp in the RT unit's buffer, merged by sector.
//
// Lanes that want the same sector share one request, whether it still waits for the L1 port or is
// already under way. Requests are sent in the order in which their line was first asked for.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "a2rt/base/units.h"
#include "a2rt/rt/event.h"
#include "a2rt/timing/tag_store.h"

namespace a2rt::timing {

class RequestTable {
 public:
  RequestTable();

  // Lane `lane` wants the sectors of [address, address + bytes). Returns how many of
  // them it was not waiting for already.
  std::uint32_t add(std::uint32_t lane, Address address, std::uint32_t bytes, Traffic kind);

  bool nothing_to_send() const { return first_ == kNil; }
  struct Next {
    Address sector;
    Traffic kind;
    std::uint32_t token;  // to be given back to arrived()
  };
  Next next() const;
  // The request shown by next() was accepted.
  void sent();
  // The sector's data came; returns the lanes that wanted it (bit per lane).
  std::uint32_t arrived(std::uint32_t token);

  std::uint32_t live() const { return live_; }

 private:
  static constexpr std::uint16_t kNil = 0xffff;
  static constexpr std::size_t kBuckets = 128;
  struct Entry {
    std::uint64_t line = 0;
    std::array<std::uint32_t, kSectorsPerLine> lanes{};
    std::uint16_t hash_next = kNil, queue_next = kNil;
    std::uint8_t to_send = 0, in_flight = 0;
    Traffic kind = Traffic::kNone;
  };
  std::size_t bucket(std::uint64_t line) const { return (line * 0x9e3779b97f4a7c15u) >> 57; }
  std::uint16_t obtain(std::uint64_t line, Traffic kind);

  std::vector<Entry> entries_;
  std::array<std::uint16_t, kBuckets> buckets_;
  std::uint16_t free_ = kNil, first_ = kNil, last_ = kNil;
  std::uint32_t live_ = 0;
};

}  // namespace a2rt::timing
