// A port of one use per cycle that is reserved ahead of time and in any order: what is ready early
// does not queue behind what was promised first but is ready later.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/base/units.h"

namespace a2rt::timing {

class ReservedPort {
 public:
  ReservedPort() : words_(kLeastWords) {}

  // First of `n` consecutive free cycles at or after `ready`, which are taken; n is at most 32.
  // Cycles before `now` will not be asked for again; `now` only moves forward.
  Cycles take(Cycles now, Cycles ready, std::uint32_t n) {
    forget_before(now.value / 64);
    A2RT_CHECK(ready.value / 64 >= first_word_, "a port was asked for a cycle of the past");
    std::uint64_t at = ready.value;
    while (true) {
      while ((at + 128) / 64 >= first_word_ + words_.size()) [[unlikely]] {
        grow();
      }
      const std::uint64_t starts = starts_of(~look(at), n);
      if (starts != 0) [[likely]] {
        at += static_cast<std::uint64_t>(std::countr_zero(starts));
        mark(at, n);
        return Cycles{at};
      }
      at += 65 - n;
    }
  }

 private:
  static constexpr std::size_t kLeastWords = 16;
  std::uint64_t& word(std::uint64_t index) { return words_[index & (words_.size() - 1)]; }
  // The 64 cycles from `at` on, as bits.
  std::uint64_t look(std::uint64_t at) {
    const std::uint64_t low = word(at / 64) >> (at % 64);
    return at % 64 == 0 ? low : low | word(at / 64 + 1) << (64 - at % 64);
  }
  // Bits from which on `n` bits are set.
  static std::uint64_t starts_of(std::uint64_t free, std::uint32_t n) {
    for (std::uint32_t i = 1; i < n; ++i) {
      free &= free >> 1;
    }
    return free;
  }
  void mark(std::uint64_t at, std::uint32_t n) {
    const std::uint64_t bits = (std::uint64_t{1} << n) - 1;
    word(at / 64) |= bits << (at % 64);
    if (at % 64 + n > 64) {
      word(at / 64 + 1) |= bits >> (64 - at % 64);
    }
  }
  void forget_before(std::uint64_t index) {
    for (; first_word_ < index; ++first_word_) {
      if (index - first_word_ > words_.size()) [[unlikely]] {
        first_word_ = index - words_.size();
      }
      word(first_word_) = 0;
    }
  }
  void grow() {
    std::vector<std::uint64_t> old(words_.size() * 2);
    old.swap(words_);
    for (std::uint64_t i = 0; i < old.size(); ++i) {
      word(first_word_ + i) = old[(first_word_ + i) & (old.size() - 1)];
    }
  }

  std::vector<std::uint64_t> words_;  // ring; bit i of word w: cycle 64 w + i is taken
  std::uint64_t first_word_ = 0;
};

}  // namespace a2rt::timing
