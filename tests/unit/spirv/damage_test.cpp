// Damaged modules are refused or rewritten, never crash and never hang.
#include <gtest/gtest.h>

#include <chrono>
#include <random>

#include "spirv/instrument.h"
#include "test_modules.h"

namespace a2rt::spirv {
namespace {

using testing::all_modules;

using Clock = std::chrono::steady_clock;
// Generous: a healthy module takes about a millisecond, also under a sanitizer a few.
constexpr auto kLongestAnswer = std::chrono::seconds(5);

// True if the module was refused; any other exception fails the test.
bool refused(const std::vector<std::uint32_t>& words) {
  const auto start = Clock::now();
  bool result = false;
  try {
    instrument(words, {});
  } catch (const SpirvError& error) {
    result = true;
    EXPECT_LE(error.word_offset(), words.size());
  }
  EXPECT_LT(Clock::now() - start, kLongestAnswer);
  return result;
}

TEST(Damage, ModulesCutAtAnyWordAreRefusedOrComplete) {
  for (const auto& module : all_modules()) {
    if (!module.name.ends_with(".v12") && !module.name.ends_with(".asm")) {
      continue;
    }
    std::size_t refusals = 0;
    for (std::size_t length = 0; length < module.words.size(); ++length) {
      refusals += refused(
          {module.words.begin(), module.words.begin() + static_cast<std::ptrdiff_t>(length)});
    }
    // What is not refused ends between two instructions outside of a function.
    EXPECT_GT(refusals, module.words.size() / 2) << module.name;
  }
}

TEST(Damage, RandomWordsAnywhereAreSurvived) {
  std::mt19937 random(20240607);
  std::size_t refusals = 0;
  std::size_t tries = 0;
  for (const auto& module : all_modules()) {
    for (int round = 0; round < 60; ++round) {
      auto words = module.words;
      const auto changes = 1 + random() % 4;
      for (auto c = changes; c > 0; --c) {
        std::uint32_t& word = words[random() % words.size()];
        switch (random() % 4) {
          case 0:
            word = static_cast<std::uint32_t>(random());
            break;
          case 1:
            word ^= 1u << (random() % 32);
            break;
          case 2:
            word = words[random() % words.size()];
            break;
          default:
            word = static_cast<std::uint32_t>(
                random() % module.words[3]);  // another id, most likely one that exists
            break;
        }
      }
      refusals += refused(words);
      ++tries;
    }
  }
  EXPECT_GT(refusals, tries / 20);
  EXPECT_LT(refusals, tries);
}

TEST(Damage, InstructionsInTheWrongPlaceAreSurvived) {
  std::mt19937 random(7);
  for (const auto& module : all_modules()) {
    // Starts of instructions, so that the stream stays well-formed.
    std::vector<std::size_t> starts;
    for (std::size_t at = 5; at < module.words.size(); at += module.words[at] >> 16) {
      starts.push_back(at);
    }
    for (int round = 0; round < 20; ++round) {
      auto words = module.words;
      const std::size_t from = starts[random() % starts.size()];
      const std::size_t length = module.words[from] >> 16;
      const std::vector<std::uint32_t> moved(
          module.words.begin() + static_cast<std::ptrdiff_t>(from),
          module.words.begin() + static_cast<std::ptrdiff_t>(from + length));
      const std::size_t to = starts[random() % starts.size()];
      if (round % 2 == 0) {
        words.erase(words.begin() + static_cast<std::ptrdiff_t>(from),
                    words.begin() + static_cast<std::ptrdiff_t>(from + length));
      } else {
        words.insert(words.begin() + static_cast<std::ptrdiff_t>(to), moved.begin(), moved.end());
      }
      refused(words);
    }
  }
}

TEST(Damage, TypesInCirclesDoNotHang) {
  auto words = testing::module_named("recursive.rchit.v12");
  for (std::size_t at = 5; at < words.size(); at += words[at] >> 16) {
    if ((words[at] & 0xffffu) == 30u) {  // OpTypeStruct: every member is the struct itself
      std::fill(words.begin() + static_cast<std::ptrdiff_t>(at + 2),
                words.begin() + static_cast<std::ptrdiff_t>(at + (words[at] >> 16)), words[at + 1]);
    }
  }
  refused(words);
}

}  // namespace
}  // namespace a2rt::spirv
