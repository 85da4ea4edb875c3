// A port reserved ahead of time, against a plain list of the cycles that are taken.
#include "a2rt/timing/reserved_port.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace a2rt::timing::test {
namespace {

TEST(ReservedPort, what_is_ready_early_goes_before_what_was_promised_first) {
  ReservedPort port;
  EXPECT_EQ(port.take(Cycles{0}, Cycles{160}, 4), Cycles{160});
  EXPECT_EQ(port.take(Cycles{0}, Cycles{20}, 1), Cycles{20});
  EXPECT_EQ(port.take(Cycles{0}, Cycles{158}, 4), Cycles{164});
  EXPECT_EQ(port.take(Cycles{0}, Cycles{158}, 2), Cycles{158});
}

// The first run of free cycles from `ready` on.
std::uint64_t expected(std::set<std::uint64_t>& taken, std::uint64_t ready, std::uint32_t n) {
  for (std::uint64_t at = ready;; ++at) {
    bool free = true;
    for (std::uint64_t c = at; c < at + n; ++c) {
      free = free && taken.count(c) == 0;
    }
    if (free) {
      for (std::uint64_t c = at; c < at + n; ++c) {
        taken.insert(c);
      }
      return at;
    }
  }
}

class AnyOrder : public ::testing::TestWithParam<std::uint32_t> {};

TEST_P(AnyOrder, reservations_equal_those_of_a_list_of_taken_cycles) {
  std::mt19937 random(GetParam());
  ReservedPort port;
  std::set<std::uint64_t> taken;
  std::uint64_t now = random() % 1000;
  for (int i = 0; i < 3000; ++i) {
    now += random() % 4 == 0 ? random() % 40 : 0;
    now += random() % 500 == 0 ? 5000U : 0U;
    // Far beyond the ring now and then, which makes it grow.
    const std::uint64_t ready = now + random() % (random() % 200 == 0 ? 4000 : 300);
    const std::uint32_t n = 1 + random() % 4;
    ASSERT_EQ(port.take(Cycles{now}, Cycles{ready}, n), Cycles{expected(taken, ready, n)})
        << "reservation " << i << " of " << n << " cycles from " << ready << " at " << now;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, AnyOrder, ::testing::Range(0u, 20u));

}  // namespace
}  // namespace a2rt::timing::test
