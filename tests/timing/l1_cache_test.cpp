// L1: latency, banks, MSHRs, write policies. Exact cycles.
#include "a2rt/timing/l1_cache.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "mocks.h"

namespace a2rt::timing::test {
namespace {

constexpr Cycles kBelow{100};

struct L1 : ::testing::Test {
  L1Config config;
  Calendar calendar;
  FixedLower lower{calendar, kBelow};
  RecordingClient client;
  // Wide enough not to be what limits; tests about the port make their own.
  Port port{64};
  std::unique_ptr<L1Cache> uut;
  void build() {
    uut = std::make_unique<L1Cache>(config, lower, 0);
    lower.sink = uut.get();
  }
  // One sector.
  L1Cache::Lookup read(Cycles now, std::uint64_t address, std::uint32_t token) {
    const Address a{address};
    const L1Cache::Lookup found =
        uut->read(now, port, Address{line_of(a) * kLineBytes},
                  static_cast<SectorMask>(1u << sector_index(a)), Traffic::kNode, client, token);
    if (found.hits != 0) {
      client.ready[token] = found.ready[sector_index(a)];
    }
    return found;
  }
  void write(Cycles now, std::uint64_t address, Traffic kind) {
    const Address a{address};
    uut->write(now, port, Address{line_of(a) * kLineBytes},
               static_cast<SectorMask>(1u << sector_index(a)), kind);
  }
  // Makes `address` resident; returns the present cycle.
  Cycles warm(std::uint64_t address) {
    read(calendar.now(), address, 9999);
    return drain(calendar) + Cycles{1};
  }
};

TEST_F(L1, a_hit_is_ready_exactly_its_latency_after_it_was_accepted) {
  build();
  const Cycles start = warm(0);
  EXPECT_NE(read(start, 0, 1).hits, 0);
  EXPECT_EQ(client.ready.at(1), start + config.latency);
  uut->check_drained();
}

TEST_F(L1, a_miss_leaves_after_the_latency_and_is_answered_when_filled) {
  build();
  EXPECT_EQ(read(Cycles{0}, 64, 1).hits, 0);
  ASSERT_EQ(lower.seen.size(), 1u);
  EXPECT_EQ(lower.seen[0].leaves, config.latency);
  drain(calendar);
  EXPECT_EQ(client.ready.at(1), config.latency + kBelow);
  EXPECT_EQ(uut->counts().misses[static_cast<std::size_t>(Traffic::kNode)], 1u);
}

TEST_F(L1, two_reads_of_one_missing_sector_cost_one_request_below) {
  build();
  read(Cycles{0}, 64, 1);
  At second(calendar, Cycles{5}, [&](Cycles now) { read(now, 64, 2); });
  drain(calendar);
  EXPECT_EQ(lower.seen.size(), 1u);
  EXPECT_EQ(client.ready.at(1), config.latency + kBelow);
  EXPECT_EQ(client.ready.at(2), config.latency + kBelow);
  uut->check_drained();
}

TEST_F(L1, a_read_merged_just_before_the_fill_still_takes_the_latency) {
  build();
  read(Cycles{0}, 64, 1);
  const Cycles fill = config.latency + kBelow;
  At second(calendar, fill - Cycles{1}, [&](Cycles now) { read(now, 64, 2); });
  drain(calendar);
  EXPECT_EQ(client.ready.at(2), fill - Cycles{1} + config.latency);
}

TEST_F(L1, one_bank_serves_one_access_per_cycle) {
  build();
  warm(0);
  const std::uint64_t same_bank = kSectorBytes * config.banks;
  const Cycles start = warm(same_bank);
  read(start, 0, 1);
  read(start, same_bank, 2);
  EXPECT_EQ(client.ready.at(1), start + config.latency);
  EXPECT_EQ(client.ready.at(2), start + config.latency + Cycles{1});
  EXPECT_EQ(uut->counts().bank_conflicts, 1u);
}

TEST_F(L1, different_banks_serve_accesses_in_the_same_cycle) {
  build();
  warm(0);
  const Cycles start = warm(kSectorBytes);
  read(start, 0, 1);
  read(start, kSectorBytes, 2);
  EXPECT_EQ(client.ready.at(1), client.ready.at(2));
  EXPECT_EQ(client.ready.at(1), start + config.latency);
}

TEST_F(L1, sectors_of_a_line_go_through_a_narrow_port_one_cycle_apart) {
  build();
  for (std::uint64_t s = 0; s < kSectorsPerLine; ++s) {
    warm(s * kSectorBytes);
  }
  const Cycles start = calendar.now() + Cycles{10};
  Port narrow{1};
  const L1Cache::Lookup found =
      uut->read(start, narrow, Address{0}, 0xf, Traffic::kNode, client, 1);
  EXPECT_EQ(found.hits, 0xf);
  for (std::uint64_t s = 0; s < kSectorsPerLine; ++s) {
    EXPECT_EQ(found.ready[s], start + Cycles{s} + config.latency);
  }
}

TEST_F(L1, two_clients_on_one_bank_get_alternate_cycles) {
  build();
  const Cycles start = warm(0);
  Port first{1}, second{1};
  for (std::uint64_t i = 0; i < 8; ++i) {
    const Cycles a = uut->read(start, first, Address{0}, 1, Traffic::kNode, client, 1).ready[0];
    const Cycles b = uut->read(start, second, Address{0}, 1, Traffic::kNode, client, 2).ready[0];
    EXPECT_EQ(a, start + config.latency + Cycles{2 * i});
    EXPECT_EQ(b, start + config.latency + Cycles{2 * i + 1});
  }
}

TEST_F(L1, full_mshrs_turn_a_read_away_until_a_fill_frees_one) {
  config.mshrs = 2;
  build();
  EXPECT_NE(read(Cycles{0}, 0, 1).accepted, 0);
  EXPECT_NE(read(Cycles{0}, 32, 2).accepted, 0);
  const L1Cache::Lookup third = read(Cycles{0}, 64, 3);
  EXPECT_EQ(third.accepted, 0);
  EXPECT_TRUE(third.mshrs_full);
  drain(calendar);
  ASSERT_FALSE(client.unblocked_at.empty());
  EXPECT_EQ(client.unblocked_at.front(), config.latency + kBelow);
  EXPECT_NE(read(calendar.now(), 64, 3).accepted, 0);
  drain(calendar);
  uut->check_drained();
}

TEST_F(L1, a_line_that_half_fits_into_the_mshrs_is_half_accepted) {
  config.mshrs = 2;
  build();
  const L1Cache::Lookup found =
      uut->read(Cycles{0}, port, Address{0}, 0xf, Traffic::kNode, client, 1);
  EXPECT_EQ(found.accepted, 0x3);
  EXPECT_TRUE(found.mshrs_full);
  drain(calendar);
  uut->check_drained();
}

TEST_F(L1, a_sector_takes_a_limited_number_of_merged_reads) {
  config.merges = 2;
  build();
  EXPECT_NE(read(Cycles{0}, 0, 1).accepted, 0);
  EXPECT_NE(read(Cycles{0}, 0, 2).accepted, 0);
  EXPECT_EQ(read(Cycles{0}, 0, 3).accepted, 0);
  drain(calendar);
  EXPECT_EQ(client.ready.count(3), 0u);
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
  write(Cycles{0}, 0, Traffic::kShader);
  ASSERT_EQ(lower.seen.size(), 1u);
  EXPECT_TRUE(lower.seen[0].write);
  EXPECT_EQ(lower.seen[0].leaves, config.latency);
  EXPECT_FALSE(uut->tags().contains(Address{0}));
}

TEST_F(L1, a_spilled_stack_sector_is_kept_and_written_back_when_evicted) {
  config.capacity = Bytes{kLineBytes};
  build();
  write(Cycles{0}, 0, Traffic::kStack);
  EXPECT_TRUE(lower.seen.empty());
  warm(kLineBytes + kSectorBytes);
  ASSERT_EQ(lower.seen.size(), 2u);
  EXPECT_TRUE(lower.seen[1].write);
  EXPECT_EQ(lower.seen[1].line, Address{0});
}

TEST_F(L1, an_answer_nobody_asked_for_is_an_error) {
  build();
  EXPECT_THROW(uut->fill(Cycles{0}, Address{0}, 1), InternalError);
}

TEST_F(L1, an_unanswered_read_fails_the_drain_check) {
  lower.hold = true;
  build();
  read(Cycles{0}, 0, 1);
  drain(calendar);
  EXPECT_THROW(uut->check_drained(), InternalError);
}

TEST(Port, throws_when_overspent_in_one_cycle_and_starts_afresh_in_the_next) {
  Port uut(2);
  EXPECT_EQ(uut.next(Cycles{5}), Cycles{5});
  uut.use(Cycles{5});
  uut.use(Cycles{5});
  EXPECT_EQ(uut.next(Cycles{5}), Cycles{6});
  EXPECT_THROW(uut.use(Cycles{5}), InternalError);
  uut.use(Cycles{6});
  EXPECT_THROW(uut.use(Cycles{5}), InternalError);
  EXPECT_THROW(Port(0), InternalError);
}

TEST(Port, at_half_the_core_clock_opens_every_second_core_cycle) {
  Port uut(1, ClockDomain(500, 1000));
  EXPECT_EQ(uut.next(Cycles{3}), Cycles{4});
  uut.use(Cycles{4});
  EXPECT_EQ(uut.next(Cycles{4}), Cycles{6});
  EXPECT_THROW(uut.use(Cycles{5}), InternalError);
}

TEST(Banks, refuse_a_cycle_that_is_taken) {
  Banks uut(2);
  EXPECT_EQ(uut.free_from(0, Cycles{0}), Cycles{0});
  uut.take(0, Cycles{0});
  EXPECT_THROW(uut.take(0, Cycles{0}), InternalError);
  EXPECT_EQ(uut.free_from(0, Cycles{0}), Cycles{1});
  uut.take(1, Cycles{0});
  uut.take(0, Cycles{2});
  uut.advance(Cycles{1});
  EXPECT_EQ(uut.free_from(0, Cycles{1}), Cycles{1});
  EXPECT_EQ(uut.free_from(0, Cycles{2}), Cycles{3});
  EXPECT_THROW(uut.take(0, Cycles{2}), InternalError);
  EXPECT_THROW(uut.take(0, Cycles{65}), InternalError);
}

TEST(Banks, take_a_whole_message_or_nothing_of_it) {
  Banks uut(8);
  uut.take(4 + 2, Cycles{11});
  EXPECT_FALSE(uut.take_all(1, 0b0110, Cycles{10}, kInTurn[0b0110]));
  EXPECT_EQ(uut.free_from(4 + 1, Cycles{10}), Cycles{10});
  EXPECT_EQ(uut.take_all(0, 0b0110, Cycles{10}, kInTurn[0b0110]), Cycles{10});
  EXPECT_EQ(uut.take_all(3, 0b0110, Cycles{10}, kTogether[0b0110]), Cycles{10});
  EXPECT_EQ(uut.free_from(2, Cycles{11}), Cycles{12});
  EXPECT_EQ(uut.free_from(4 + 2, Cycles{10}), Cycles{12});
  uut.advance(Cycles{200});
  EXPECT_EQ(uut.free_from(2, Cycles{200}), Cycles{200});
}

TEST(Banks, delay_a_message_until_its_first_sector_passes) {
  Banks uut(4);
  uut.take(1, Cycles{5});
  uut.take(1, Cycles{6});
  EXPECT_EQ(uut.take_all(0, 0b0110, Cycles{5}, kInTurn[0b0110]), Cycles{7});
  EXPECT_EQ(uut.free_from(2, Cycles{7}), Cycles{7});
  EXPECT_EQ(uut.free_from(2, Cycles{8}), Cycles{9});
}

TEST(Banks, leave_messages_to_their_sectors_where_sectors_of_a_line_share_a_bank) {
  Banks uut(2);
  EXPECT_FALSE(uut.take_all(0, 0b0101, Cycles{0}, kTogether[0b0101]));
}

// A cache's port and banks as they are described: each sector by itself, in the first cycle of the
// port's clock that has room for it and finds its bank free, never before the sector ahead of it.
class PlainEntrance {
 public:
  PlainEntrance(std::uint32_t limit, ClockDomain clock) : limit_(limit), clock_(clock) {}
  Cycles next(Cycles now) const { return clock_.to_core(edge(now)); }
  // `taken`: cycles and banks in use, for all ports of the cache.
  Cycles send(Cycles now, std::uint64_t bank,
              std::set<std::pair<std::uint64_t, std::uint64_t>>& taken) {
    Cycles own = edge(now);
    while (!taken.insert({clock_.to_core(own).value, bank}).second) {
      own = own + Cycles{1};
    }
    used_ = own == last_ ? used_ + 1 : 1;
    last_ = own;
    return clock_.to_core(own);
  }

 private:
  Cycles edge(Cycles now) const {
    Cycles own = used_ < limit_ ? last_ : last_ + Cycles{1};
    while (clock_.to_core(own) < now) {
      own = own + Cycles{1};
    }
    return own;
  }
  std::uint32_t limit_, used_ = 0;
  ClockDomain clock_;
  Cycles last_;
};

using Clock = std::pair<std::uint64_t, std::uint64_t>;  // the RT unit's and the core's, in MHz

struct L1Messages : L1,
                    ::testing::WithParamInterface<std::tuple<std::uint32_t, std::uint32_t, Clock>> {
  std::set<std::pair<std::uint64_t, std::uint64_t>> taken;
  std::uint64_t conflicts = 0;
  // When each of the sectors enters the cache, and goes on from there.
  SectorTimes entered(Cycles now, PlainEntrance& entrance, std::uint64_t line, SectorMask sectors) {
    SectorTimes times{};
    for_each_bit(sectors, [&](std::uint32_t s) {
      const Cycles wanted = entrance.next(now);
      const Cycles at = entrance.send(now, (line * kSectorsPerLine + s) % config.banks, taken);
      conflicts += at.value - wanted.value;
      times[s] = at + config.latency;
    });
    return times;
  }
  // The earliest start at which sectors a cycle apart are all there.
  static Cycles departure(SectorMask sectors, const SectorTimes& times) {
    for (Cycles leaves;; leaves = leaves + Cycles{1}) {
      bool all = true;
      std::uint64_t position = 0;
      for_each_bit(sectors,
                   [&](std::uint32_t s) { all = all && times[s] <= leaves + Cycles{position++}; });
      if (all) {
        return leaves;
      }
    }
  }
};

INSTANTIATE_TEST_SUITE_P(
    PortsBanksClocks, L1Messages,
    ::testing::Combine(::testing::Values(1u, 2u, 3u, 4u), ::testing::Values(1u, 2u, 3u, 4u, 6u, 8u),
                       ::testing::Values(Clock{1365, 1365}, Clock{1, 2}, Clock{171, 1365})));

TEST_P(L1Messages, take_the_times_and_conflicts_of_their_sectors_one_by_one) {
  const auto [limit, banks, mhz] = GetParam();
  const ClockDomain clock(mhz.first, mhz.second);
  config.banks = banks;
  config.mshrs = config.merges = 100'000;
  build();
  // The RT unit's port, and the load/store unit's, which gets into its way now and then.
  std::array<Port, 2> ports{Port(limit, clock), Port(4)};
  std::array<PlainEntrance, 2> plain{PlainEntrance(limit, clock), PlainEntrance(4, {})};
  std::mt19937 random(limit * 100 + banks);
  std::map<std::uint64_t, SectorMask> asked;
  std::map<std::uint32_t, Cycles> expected;  // of misses, by token
  std::uint64_t hits = 0, misses = 0;
  const auto message = [&](Cycles now, std::size_t unit, std::uint32_t token) {
    const std::uint64_t line = random() % 256;
    const auto sectors = static_cast<SectorMask>(random() % 15 + 1);
    const SectorTimes times = entered(now, plain[unit], line, sectors);
    const Address at{line * kLineBytes};
    if (random() % 8 == 0) {
      uut->write(now, ports[unit], at, sectors, Traffic::kShader);
      ASSERT_EQ(lower.seen.back().leaves, departure(sectors, times));
      return;
    }
    const std::size_t requests = lower.seen.size();
    const L1Cache::Lookup found =
        uut->read(now, ports[unit], at, sectors, Traffic::kNode, client, token);
    ASSERT_EQ(found.accepted, sectors);
    const auto fresh = static_cast<SectorMask>(sectors & ~asked[line]);
    asked[line] = static_cast<SectorMask>(asked[line] | sectors);
    ASSERT_EQ(found.hits & fresh, 0);
    for_each_bit(found.hits, [&](std::uint32_t s) { ASSERT_EQ(found.ready[s], times[s]); });
    ASSERT_EQ(lower.seen.size() - requests, fresh != 0 ? 1u : 0u);
    if (fresh != 0) {
      ASSERT_EQ(lower.seen.back().sectors, fresh);
      ASSERT_EQ(lower.seen.back().leaves, departure(fresh, times));
    }
    if (fresh == sectors) {  // nothing of it was on its way already
      expected[token] =
          departure(fresh, times) + kBelow + Cycles{std::uint64_t{sectors_in(fresh)} - 1};
    }
    hits += sectors_in(found.hits);
    misses += sectors_in(fresh);
  };
  std::vector<std::unique_ptr<At>> steps;
  Cycles when{10};
  for (std::uint32_t i = 0; i < 1500; ++i, when = when + Cycles{random() % 6}) {
    steps.push_back(std::make_unique<At>(calendar, when, [&, i](Cycles now) {
      const std::size_t unit = random() % 4 == 0 ? 1 : 0;
      // As far ahead as units send.
      if (!HasFatalFailure() && ports[unit].next(now) < now + Cycles{8}) {
        message(now, unit, i);
      }
    }));
  }
  drain(calendar);
  for (const auto& [token, ready] : expected) {
    ASSERT_EQ(client.ready.at(token), ready);
  }
  EXPECT_EQ(uut->counts().bank_conflicts, conflicts);
  EXPECT_GT(conflicts, 0u);
  EXPECT_GT(hits, 300u);
  EXPECT_GT(misses, 300u);
  uut->check_drained();
}

}  // namespace
}  // namespace a2rt::timing::test
