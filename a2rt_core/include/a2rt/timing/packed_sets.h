// Tags of sets of up to 16 ways with true LRU, as close together as they get: simulators spend much
// of their time waiting for the host's memory, and a GPU's L2 has tens of thousands of tags.
//
// A set is three lines of the host. A lookup compares a byte of every way's tag at once, so it
// reads the first of them and mostly one other; the order of use is a rank per way.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "a2rt/timing/sectors.h"
#include "a2rt/timing/wrap.h"

namespace a2rt::timing {

class PackedSets {
 public:
  static constexpr std::uint32_t kMostWays = 16;

  // `ways`: 1 to kMostWays.
  PackedSets(std::uint64_t sets, std::uint32_t ways);

  // As in TagStore; `line` is a line number.
  std::uint32_t places() const { return static_cast<std::uint32_t>(kinds_.size()); }
  Held look(std::uint64_t line) const {
    const std::size_t index = wrap_.of(line);
    const std::uint32_t way = find(sets_[index], line);
    return way == kNoWay
               ? Held{places(), 0}
               : Held{static_cast<std::uint32_t>(index * kMostWays + way), sets_[index].valid[way]};
  }
  std::uint32_t guess(std::uint64_t line) const {
    return static_cast<std::uint32_t>(wrap_.of(line)) * kMostWays;
  }
  void use(std::uint32_t place) { make_newest(sets_[place / kMostWays], place % kMostWays); }
  void prefetch(std::uint64_t line) const {
    const Set& set = sets_[wrap_.of(line)];
    __builtin_prefetch(&set);
    __builtin_prefetch(&set.line[0]);
    __builtin_prefetch(&set.line[kMostWays / 2]);
  }
  Entered enter(Cycles now, std::uint32_t place, std::uint64_t line, SectorMask sectors,
                Traffic kind, bool dirty, SectorResidence& residence) {
    const std::uint32_t way = place < places() ? place % kMostWays : kNoWay;
    return put(now, way, line, sectors, kind, dirty, residence);
  }

 private:
  static constexpr std::uint32_t kNoWay = kMostWays;
  static constexpr std::uint64_t kUnused = ~std::uint64_t{0};
  using Bytes16 = std::array<std::uint8_t, kMostWays>;
  struct alignas(64) Set {
    Bytes16 digest{};  // a byte of each way's line, hashed
    Bytes16 rank{};    // 0: used last; ways that the set does not have: 0xff
    std::array<SectorMask, kMostWays> valid{}, dirty{};
    std::array<std::uint64_t, kMostWays> line{};
  };

  // `way`: of the line, or kNoWay.
  Entered put(Cycles now, std::uint32_t way, std::uint64_t line, SectorMask sectors, Traffic kind,
              bool dirty, SectorResidence& residence);
  static std::uint8_t digest_of(std::uint64_t line) {
    return static_cast<std::uint8_t>(mixed(line) >> 56);
  }
  // The first byte equal to `wanted` that `accept` takes. A byte may look equal when it is not,
  // but only above one that is.
  template <class Accept>
  static std::uint32_t find_byte(const Bytes16& bytes, std::uint8_t wanted, const Accept& accept) {
    static_assert(std::endian::native == std::endian::little);
    constexpr std::uint64_t kOnes = 0x0101010101010101u;
    for (std::uint32_t half = 0; half < 2; ++half) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes.data() + half * 8, 8);
      word ^= wanted * kOnes;
      for (std::uint64_t zero = (word - kOnes) & ~word & kOnes << 7; zero != 0; zero &= zero - 1) {
        const auto i = half * 8 + static_cast<std::uint32_t>(std::countr_zero(zero)) / 8;
        if (accept(i)) {
          return i;
        }
      }
    }
    return kNoWay;
  }
  static std::uint32_t find(const Set& set, std::uint64_t line) {
    return find_byte(set.digest, digest_of(line),
                     [&](std::uint32_t way) { return set.line[way] == line; });
  }
  static void make_newest(Set& set, std::uint32_t way) {
    const std::uint8_t rank = set.rank[way];
    for (std::uint8_t& other : set.rank) {
      other = static_cast<std::uint8_t>(other + (other < rank));
    }
    set.rank[way] = 0;
  }

  std::vector<Set> sets_;
  std::vector<SectorKinds> kinds_;  // kMostWays per set
  Wrap wrap_;
  std::uint8_t oldest_rank_;
};

}  // namespace a2rt::timing
