// Any bytes are either refused with a SpirvError or rewritten into a stream that parses again.
//
// Mutations know the structure: they change, move, drop and repeat whole instructions and replace
// ids by other ids, so that most inputs get past the parser and into the rewriter.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <random>
#include <vector>

#include "spirv/instrument.h"
#include "spirv/module.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

using namespace a2rt::spirv;
using Words = std::vector<std::uint32_t>;

constexpr std::size_t kHeader = Module::kHeaderWords;

Words to_words(const std::uint8_t* data, std::size_t size) {
  Words words(size / 4);
  if (!words.empty()) {
    std::memcpy(words.data(), data, words.size() * 4);
  }
  return words;
}

void check(bool condition) {
  if (!condition) {
    std::abort();
  }
}

InstrumentOptions options_from(std::uint32_t bits) {
  InstrumentOptions options;
  options.header_address = 0x500000000000 + bits;
  options.rays = (bits & 1) == 0;
  options.results = (bits & 2) == 0;
  options.candidates = (bits & 4) == 0;
  options.counters = (bits & 8) == 0;
  options.verdicts = (bits & 16) == 0;
  options.site_limit = (bits & 32) == 0 ? UINT32_MAX : 1;
  return options;
}

// First words of the instructions, as far as the stream is well-formed.
std::vector<std::size_t> instruction_starts(const Words& words) {
  std::vector<std::size_t> starts;
  for (std::size_t at = kHeader; at < words.size();) {
    const std::size_t length = words[at] >> 16;
    if (length == 0 || length > words.size() - at) {
      break;
    }
    starts.push_back(at);
    at += length;
  }
  return starts;
}

class Mutator {
 public:
  Mutator(Words& words, std::uint32_t seed) : words_(words), random_(seed) {}

  void run() {
    const std::vector<std::size_t> starts = instruction_starts(words_);
    if (starts.empty()) {
      return;
    }
    const std::size_t at = starts[pick(starts.size())];
    const std::size_t length = words_[at] >> 16;
    switch (pick(6)) {
      case 0:  // drop
        words_.erase(position(at), position(at + length));
        break;
      case 1: {  // repeat elsewhere
        const Words copy(position(at), position(at + length));
        words_.insert(position(starts[pick(starts.size())]), copy.begin(), copy.end());
        break;
      }
      case 2:  // another opcode of the same length
        words_[at] = (words_[at] & 0xffff0000u) | (words_[starts[pick(starts.size())]] & 0xffffu);
        break;
      case 3:  // another operand of the module
        if (length > 1) {
          const std::size_t other = starts[pick(starts.size())];
          words_[at + 1 + pick(length - 1)] = words_[other + pick(words_[other] >> 16)];
        }
        break;
      case 4:  // another id
        if (length > 1) {
          words_[at + 1 + pick(length - 1)] = static_cast<std::uint32_t>(pick(words_[3] + 1));
        }
        break;
      default:  // shorter or longer, with the length word adjusted
        if (length > 1 && pick(2) == 0) {
          words_.erase(position(at + length - 1));
          words_[at] -= 1u << 16;
        } else if (length < 0xffff) {
          words_.insert(position(at + length), static_cast<std::uint32_t>(pick(words_[3] + 1)));
          words_[at] += 1u << 16;
        }
        break;
    }
  }

 private:
  std::size_t pick(std::size_t count) { return count == 0 ? 0 : random_() % count; }
  Words::iterator position(std::size_t at) {
    return words_.begin() + static_cast<std::ptrdiff_t>(at);
  }

  Words& words_;
  std::mt19937 random_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Words words = to_words(data, size);
  try {
    check(Module::parse(words).words() == words);
    const Specialization specializations[] = {{0, 4}, {5, 1}};
    analyse(words, specializations);
    // The generator word, which means nothing to us, chooses the options.
    const InstrumentResult result = instrument(words, options_from(words[2]));
    check(result.instrumented || result.words == words);
    check(Module::parse(result.words).words() == result.words);
  } catch (const SpirvError& error) {
    check(error.word_offset() <= words.size());
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned int seed) {
  Words words = to_words(data, size);
  if (seed % 8 == 0 || words.size() <= kHeader) {
    return LLVMFuzzerMutate(data, size, max_size);
  }
  for (unsigned int i = 0; i <= seed / 8 % 3; ++i) {
    Mutator(words, seed + i).run();
  }
  const std::size_t bytes = std::min(words.size(), max_size / 4) * 4;
  std::memcpy(data, words.data(), bytes);
  return bytes;
}
