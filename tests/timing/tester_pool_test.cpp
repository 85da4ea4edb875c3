// k tests on u testers of latency l and interval i, against the closed form.
#include "a2rt/timing/tester_pool.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace a2rt::timing {
namespace {

using Case = std::tuple<std::uint32_t, std::uint32_t, std::uint64_t, std::uint64_t>;

class Pool : public ::testing::TestWithParam<Case> {};

TEST_P(Pool, k_independent_tests_end_when_the_closed_form_says) {
  const auto [tests, units, latency, interval] = GetParam();
  TesterPool uut(units, Cycles{latency}, Cycles{interval}, ClockDomain(1, 1));
  const std::uint64_t rounds = (tests + units - 1) / units;
  const Cycles start{1000};
  EXPECT_EQ(uut.issue(Cycles{0}, start, tests), start + Cycles{(rounds - 1) * interval + latency});
  EXPECT_EQ(uut.tests(), tests);
}

TEST_P(Pool, the_same_tests_given_one_by_one_end_at_the_same_time) {
  const auto [tests, units, latency, interval] = GetParam();
  TesterPool together(units, Cycles{latency}, Cycles{interval}, ClockDomain(1, 1));
  TesterPool apart(units, Cycles{latency}, Cycles{interval}, ClockDomain(1, 1));
  Cycles last;
  for (std::uint32_t i = 0; i < tests; ++i) {
    last = apart.issue(Cycles{0}, Cycles{0}, 1);
  }
  EXPECT_EQ(together.issue(Cycles{0}, Cycles{0}, tests), last);
}

INSTANTIATE_TEST_SUITE_P(Sweep, Pool,
                         ::testing::Combine(::testing::Values(1u, 2u, 6u, 7u, 192u),
                                            ::testing::Values(1u, 2u, 15u),
                                            ::testing::Values(1u, 6u, 27u),
                                            ::testing::Values(1u, 2u, 5u)));

TEST(Pool, an_idle_tester_is_used_again_from_its_own_time_on) {
  TesterPool uut(1, Cycles{3}, Cycles{2}, ClockDomain(1, 1));
  EXPECT_EQ(uut.issue(Cycles{0}, Cycles{0}, 1), Cycles{3});
  EXPECT_EQ(uut.issue(Cycles{0}, Cycles{1}, 1), Cycles{5});    // waits for the interval
  EXPECT_EQ(uut.issue(Cycles{0}, Cycles{10}, 1), Cycles{13});  // no wait
  EXPECT_EQ(uut.queued_cycles(), 1u);
}

TEST(Pool, an_earlier_request_that_comes_late_takes_the_cycles_still_free) {
  TesterPool uut(2, Cycles{4}, Cycles{1}, ClockDomain(1, 1));
  EXPECT_EQ(uut.issue(Cycles{0}, Cycles{10}, 3), Cycles{15});  // cycle 10 full, one left in 11
  EXPECT_EQ(uut.issue(Cycles{0}, Cycles{8}, 6), Cycles{16});   // 8, 9 full, then 11 and 12
  EXPECT_EQ(uut.issue(Cycles{0}, Cycles{8}, 1), Cycles{16});
  EXPECT_EQ(uut.issue(Cycles{0}, Cycles{13}, 1), Cycles{17});
}

TEST(Pool, a_queue_of_any_length_keeps_every_start_within_the_testers) {
  TesterPool uut(3, Cycles{1}, Cycles{1}, ClockDomain(1, 1));
  Cycles last;
  for (int i = 0; i < 1000; ++i) {
    last = uut.issue(Cycles{0}, Cycles{100}, 6);
  }
  EXPECT_EQ(last, Cycles{100 + 6000 / 3});
}

TEST(Pool, testers_at_half_the_core_clock_take_twice_the_core_cycles) {
  TesterPool uut(1, Cycles{6}, Cycles{1}, ClockDomain(500, 1000));
  EXPECT_EQ(uut.issue(Cycles{0}, Cycles{0}, 2), Cycles{14});
  EXPECT_EQ(uut.issue(Cycles{0}, Cycles{21}, 1), Cycles{34});  // next own edge is core cycle 22
}

// The model reserves tests hundreds of cycles ahead and in any order; what has passed is forgotten.
TEST(Pool, reservations_far_ahead_and_in_any_order_equal_those_of_a_list_of_all_cycles) {
  for (const std::uint64_t interval : {1u, 3u}) {
    constexpr std::uint32_t kTesters = 3;
    TesterPool uut(kTesters, Cycles{5}, Cycles{interval}, ClockDomain(1, 1));
    std::vector<std::uint32_t> busy(400'000);
    const auto fits = [&](std::uint64_t cycle) {
      for (std::uint64_t c = cycle; c < cycle + interval; ++c) {
        if (busy[c] == kTesters) {
          return false;
        }
      }
      return true;
    };
    std::mt19937_64 random(7);
    std::uint64_t now = 0;
    for (int i = 0; i < 20'000; ++i) {
      now += random() % 8;
      const std::uint64_t at = now + (random() % 8 == 0 ? random() % 3000 : random() % 200);
      const auto tests = static_cast<std::uint32_t>(1 + random() % 7);
      std::uint64_t start = at;
      for (std::uint32_t left = tests; left > 0; --left) {
        while (!fits(start)) {
          ++start;
        }
        for (std::uint64_t c = start; c < start + interval; ++c) {
          ++busy[c];
        }
      }
      ASSERT_EQ(uut.issue(Cycles{now}, Cycles{at}, tests), Cycles{start + 5}) << i;
    }
  }
}

}  // namespace
}  // namespace a2rt::timing
