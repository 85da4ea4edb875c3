// L1: latency, banks, MSHRs, write policies. Exact cycles.
#include "a2rt/timing/l1_cache.h"

#include <gtest/gtest.h>

#include "mocks.h"

namespace a2rt::timing::test {
namespace {

constexpr Cycles kBelow{100};

struct L1 : ::testing::Test {
  L1Config config;
  Calendar calendar;
  FixedLower lower{calendar, kBelow};
  RecordingClient client;
  std::unique_ptr<L1Cache> uut;
  void build() {
    uut = std::make_unique<L1Cache>(config, calendar, lower, 0);
    lower.sink = uut.get();
  }
  L1Cache::Reply read(Cycles now, std::uint64_t address, std::uint32_t token) {
    return uut->read(now, Address{address}, Traffic::kNode, client, token);
  }
  // Makes `address` resident; returns the present cycle.
  Cycles warm(std::uint64_t address) {
    uut->read(calendar.now(), Address{address}, Traffic::kNode, client, 9999);
    return drain(calendar);
  }
};

TEST_F(L1, a_hit_is_not_ready_one_cycle_before_its_latency_and_ready_at_it) {
  build();
  const Cycles start = warm(0);
  ASSERT_EQ(read(start, 0, 1), L1Cache::Reply::kAccepted);
  while (calendar.now() < start + config.latency - Cycles{1} && calendar.step()) {
  }
  EXPECT_EQ(client.first(1), start + config.latency);
  drain(calendar);
  EXPECT_EQ(calendar.now(), start + config.latency);
  uut->check_drained();
}

TEST_F(L1, a_miss_leaves_after_the_latency_and_is_answered_when_filled) {
  build();
  ASSERT_EQ(read(Cycles{0}, 64, 1), L1Cache::Reply::kAccepted);
  ASSERT_EQ(lower.seen.size(), 1u);
  EXPECT_EQ(lower.seen[0].leaves, config.latency);
  drain(calendar);
  EXPECT_EQ(client.first(1), config.latency + kBelow);
  EXPECT_EQ(uut->counts().misses[static_cast<std::size_t>(Traffic::kNode)], 1u);
}

TEST_F(L1, two_reads_of_one_missing_sector_cost_one_request_below) {
  build();
  read(Cycles{0}, 64, 1);
  At second(calendar, Cycles{5}, [&](Cycles now) { read(now, 64, 2); });
  drain(calendar);
  EXPECT_EQ(lower.seen.size(), 1u);
  EXPECT_EQ(client.first(1), config.latency + kBelow);
  EXPECT_EQ(client.first(2), config.latency + kBelow);
  uut->check_drained();
}

TEST_F(L1, a_read_merged_just_before_the_fill_still_takes_the_latency) {
  build();
  read(Cycles{0}, 64, 1);
  const Cycles fill = config.latency + kBelow;
  At second(calendar, fill - Cycles{1}, [&](Cycles now) { read(now, 64, 2); });
  drain(calendar);
  EXPECT_EQ(client.first(2), fill - Cycles{1} + config.latency);
}

TEST_F(L1, one_bank_serves_one_access_per_cycle) {
  build();
  warm(0);
  const std::uint64_t same_bank = kSectorBytes * config.banks;
  const Cycles start = warm(same_bank);
  EXPECT_EQ(read(start, 0, 1), L1Cache::Reply::kAccepted);
  EXPECT_EQ(read(start, same_bank, 2), L1Cache::Reply::kBankBusy);
  At retry(calendar, start + Cycles{1},
           [&](Cycles now) { EXPECT_EQ(read(now, same_bank, 2), L1Cache::Reply::kAccepted); });
  drain(calendar);
  EXPECT_EQ(client.first(2), start + Cycles{1} + config.latency);
  EXPECT_EQ(uut->counts().bank_conflicts, 1u);
}

TEST_F(L1, different_banks_serve_accesses_in_the_same_cycle) {
  build();
  warm(0);
  const Cycles start = warm(kSectorBytes);
  EXPECT_EQ(read(start, 0, 1), L1Cache::Reply::kAccepted);
  EXPECT_EQ(read(start, kSectorBytes, 2), L1Cache::Reply::kAccepted);
  drain(calendar);
  EXPECT_EQ(client.first(1), client.first(2));
}

TEST_F(L1, full_mshrs_turn_a_read_away_until_a_fill_frees_one) {
  config.mshrs = 2;
  build();
  EXPECT_EQ(read(Cycles{0}, 0, 1), L1Cache::Reply::kAccepted);
  EXPECT_EQ(read(Cycles{0}, 32, 2), L1Cache::Reply::kAccepted);
  EXPECT_EQ(read(Cycles{0}, 64, 3), L1Cache::Reply::kMshrFull);
  drain(calendar);
  const auto unblocked = std::find_if(client.wakeups.begin(), client.wakeups.end(),
                                      [](const auto& w) { return w.what == kL1Unblocked; });
  ASSERT_NE(unblocked, client.wakeups.end());
  EXPECT_EQ(unblocked->when, config.latency + kBelow);
  EXPECT_EQ(read(calendar.now(), 64, 3), L1Cache::Reply::kAccepted);
  drain(calendar);
  uut->check_drained();
}

TEST_F(L1, a_sector_takes_a_limited_number_of_merged_reads) {
  config.merges = 2;
  build();
  config.banks = 4;
  EXPECT_EQ(read(Cycles{0}, 0, 1), L1Cache::Reply::kAccepted);
  At second(calendar, Cycles{1},
            [&](Cycles now) { EXPECT_EQ(read(now, 0, 2), L1Cache::Reply::kAccepted); });
  At third(calendar, Cycles{2},
           [&](Cycles now) { EXPECT_EQ(read(now, 0, 3), L1Cache::Reply::kMshrFull); });
  drain(calendar);
}

TEST_F(L1, least_recently_used_line_is_evicted) {
  config.capacity = Bytes{2 * kLineBytes};
  build();
  warm(0);
  warm(kLineBytes);
  warm(0);
  warm(2 * kLineBytes);
  EXPECT_TRUE(uut->tags().contains(Address{0}));
  EXPECT_FALSE(uut->tags().contains(Address{kLineBytes}));
}

TEST_F(L1, shader_stores_go_through_and_are_not_kept) {
  build();
  EXPECT_EQ(uut->write(Cycles{0}, Address{0}, Traffic::kShader), L1Cache::Reply::kAccepted);
  ASSERT_EQ(lower.seen.size(), 1u);
  EXPECT_TRUE(lower.seen[0].write);
  EXPECT_FALSE(uut->tags().contains(Address{0}));
}

TEST_F(L1, a_spilled_stack_sector_is_kept_and_written_back_when_evicted) {
  config.capacity = Bytes{kLineBytes};
  build();
  uut->write(Cycles{0}, Address{0}, Traffic::kStack);
  EXPECT_TRUE(lower.seen.empty());
  warm(kLineBytes + kSectorBytes);
  ASSERT_EQ(lower.seen.size(), 2u);
  EXPECT_TRUE(lower.seen[1].write);
  EXPECT_EQ(lower.seen[1].sector, Address{0});
}

TEST_F(L1, an_answer_nobody_asked_for_is_an_error) {
  build();
  EXPECT_THROW(uut->fill(Cycles{0}, Address{0}), InternalError);
}

TEST_F(L1, an_unanswered_read_fails_the_drain_check) {
  lower.hold = true;
  build();
  read(Cycles{0}, 0, 1);
  drain(calendar);
  EXPECT_THROW(uut->check_drained(), InternalError);
}

}  // namespace
}  // namespace a2rt::timing::test
