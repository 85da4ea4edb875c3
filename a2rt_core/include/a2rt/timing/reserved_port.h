// A port of one use per cycle that is reserved ahead of time and in any order: what is ready early
// does not queue behind what was promised first but is ready later.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/base/inline.h"
#include "a2rt/base/units.h"

namespace a2rt::timing {

class ReservedPort {
 public:
  ReservedPort() : words_(kLeastWords) {}

  // First of `n` consecutive free cycles at or after `ready`, which are taken; n is 1 to 4, the
  // sectors of a line. Cycles before `now` will not be asked for again; `now` only moves forward.
  A2RT_INLINE Cycles take(Cycles now, Cycles ready, std::uint32_t n) {
    const std::uint64_t index = ready.value / 64;
    if (index - now.value / 64 < words_.size()) [[likely]] {
      std::uint64_t& taken = taken_in(index);
      // What lies beyond the word is shifted in as not free.
      const std::uint64_t starts = starts_of(~taken >> ready.value % 64, n);
      if (starts != 0) [[likely]] {
        const std::uint64_t at = ready.value + static_cast<std::uint64_t>(std::countr_zero(starts));
        taken |= ones(n) << at % 64;
        return Cycles{at};
      }
    }
    return take_beyond(now, ready, n);
  }

 private:
  static constexpr std::size_t kLeastWords = 16;
  // Bit i: cycle 64 `number` + i is taken. The number tells a word from what was at its place in
  // the ring before.
  struct Word {
    std::uint64_t number = 0, taken = 0;
  };
  std::uint64_t& taken_in(std::uint64_t number) {
    Word& word = words_[number & (words_.size() - 1)];
    word.taken = word.number == number ? word.taken : 0;
    word.number = number;
    return word.taken;
  }
  static std::uint64_t ones(std::uint32_t n) { return (std::uint64_t{1} << n) - 1; }
  // Bits from which on `n` bits are set.
  static std::uint64_t starts_of(std::uint64_t free, std::uint32_t n) {
    const std::uint32_t first = n > 1 ? 1 : 0;
    free &= free >> first;
    return free & free >> (n - 1 - first);
  }
  // The same as take(), across words.
  A2RT_NOINLINE Cycles take_beyond(Cycles now, Cycles ready, std::uint32_t n) {
    A2RT_CHECK(ready.value / 64 >= now.value / 64, "a port was asked for a cycle of the past");
    for (std::uint64_t at = ready.value;; at += 65 - n) {
      while (at / 64 + 1 - now.value / 64 >= words_.size()) {
        grow(now.value / 64);
      }
      const std::uint64_t starts = starts_of(~look(at), n);
      if (starts != 0) {
        at += static_cast<std::uint64_t>(std::countr_zero(starts));
        mark(at, n);
        return Cycles{at};
      }
    }
  }
  // The 64 cycles from `at` on, as bits.
  std::uint64_t look(std::uint64_t at) {
    const std::uint64_t low = taken_in(at / 64) >> at % 64;
    return at % 64 == 0 ? low : low | taken_in(at / 64 + 1) << (64 - at % 64);
  }
  void mark(std::uint64_t at, std::uint32_t n) {
    taken_in(at / 64) |= ones(n) << at % 64;
    if (at % 64 + n > 64) {
      taken_in(at / 64 + 1) |= ones(n) >> (64 - at % 64);
    }
  }
  void grow(std::uint64_t first) {
    std::vector<Word> old(words_.size() * 2);
    old.swap(words_);
    for (const Word& word : old) {
      if (word.number >= first) {
        words_[word.number & (words_.size() - 1)] = word;
      }
    }
  }

  std::vector<Word> words_;  // ring of those from the present one on
};

}  // namespace a2rt::timing
