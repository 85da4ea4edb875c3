// The fetches of a warp: what is sent when, and who is told about what came.
#include "a2rt/timing/request_table.h"

#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

namespace a2rt::timing::test {
namespace {

struct Requests : ::testing::Test {
  struct Told {
    std::uint32_t lane;
    Cycles ready;
    bool complete;
    friend bool operator==(const Told&, const Told&) = default;
  };
  RequestTable uut;
  Cycles ready;  // of what has a time already

  bool add(std::uint64_t now, std::uint32_t lane, std::uint64_t line, SectorMask sectors,
           Traffic kind = Traffic::kNode) {
    return uut.add(Cycles{now}, lane, line, sectors, kind, ready);
  }
  // Sends all that is shown next; returns its token.
  std::uint32_t send() {
    const RequestTable::Next next = uut.next();
    uut.sent(next.sectors);
    return next.token;
  }
  std::vector<Told> arrive(std::uint32_t token, SectorMask sectors, std::uint64_t first) {
    SectorTimes times{};
    for (std::uint64_t s = 0; s < kSectorsPerLine; ++s) {
      times[s] = Cycles{first + s};
    }
    std::vector<Told> told;
    uut.arrived(token, sectors, times, [&](std::uint32_t lane, Cycles at, bool complete) {
      told.push_back({lane, at, complete});
    });
    return told;
  }
  void expect_next(std::uint64_t line, SectorMask sectors, Traffic kind = Traffic::kNode) {
    ASSERT_FALSE(uut.nothing_to_send());
    EXPECT_EQ(line_of(uut.next().line), line);
    EXPECT_EQ(uut.next().sectors, sectors);
    EXPECT_EQ(uut.next().kind, kind);
  }
};

TEST_F(Requests, lines_are_sent_in_the_order_in_which_they_were_first_asked_for) {
  add(0, 0, 7, 0b0001, Traffic::kTriangle);
  add(0, 1, 3, 0b0001);
  add(0, 2, 7, 0b1000);  // goes with what the first lane wants there
  add(0, 3, 5, 0b0010);
  EXPECT_EQ(uut.live(), 3u);
  expect_next(7, 0b1001, Traffic::kTriangle);
  send();
  expect_next(3, 0b0001);
  send();
  add(0, 4, 7, 0b0100);  // asked for when the line had left the queue: behind the others
  expect_next(5, 0b0010);
  send();
  expect_next(7, 0b0100, Traffic::kTriangle);
  send();
  EXPECT_TRUE(uut.nothing_to_send());
}

TEST_F(Requests, what_the_cache_turned_away_stays_first) {
  add(0, 0, 7, 0b1111);
  add(0, 1, 3, 0b0001);
  uut.sent(0b0011);
  expect_next(7, 0b1100);
  uut.sent(0);
  expect_next(7, 0b1100);
  const std::uint32_t token = uut.next().token;
  // Those under way may come before the rest is sent.
  EXPECT_EQ(arrive(token, 0b0011, 20), (std::vector<Told>{{0, Cycles{21}, false}}));
  expect_next(7, 0b1100);
  uut.sent(0b1100);
  expect_next(3, 0b0001);
  EXPECT_EQ(arrive(token, 0b1100, 30), (std::vector<Told>{{0, Cycles{33}, true}}));
  EXPECT_EQ(uut.live(), 1u);
}

TEST_F(Requests, lanes_that_want_a_sector_share_it_and_are_told_when_their_last_one_comes) {
  EXPECT_TRUE(add(0, 0, 7, 0b0011));
  EXPECT_TRUE(add(0, 1, 7, 0b0110));
  expect_next(7, 0b0111);
  const std::uint32_t token = send();
  EXPECT_TRUE(add(1, 2, 7, 0b0100));  // under way already
  EXPECT_TRUE(uut.nothing_to_send());
  EXPECT_EQ(uut.live(), 1u);
  EXPECT_EQ(arrive(token, 0b0011, 20),
            (std::vector<Told>{{0, Cycles{21}, true}, {1, Cycles{21}, false}}));
  EXPECT_EQ(uut.live(), 1u);
  EXPECT_EQ(arrive(token, 0b0100, 40),
            (std::vector<Told>{{1, Cycles{42}, true}, {2, Cycles{42}, true}}));
  EXPECT_EQ(uut.live(), 0u);
  EXPECT_THROW(arrive(token, 0b0100, 50), InternalError);
}

TEST_F(Requests, a_sector_whose_time_is_known_is_waited_for_without_asking_again) {
  add(0, 0, 7, 0b0011);
  arrive(send(), 0b0011, 20);
  EXPECT_FALSE(add(10, 1, 7, 0b0010));
  EXPECT_EQ(ready, Cycles{21});
  ready = Cycles{0};
  EXPECT_TRUE(add(10, 2, 7, 0b0110));  // half of it
  EXPECT_EQ(ready, Cycles{21});
  expect_next(7, 0b0100);
  EXPECT_EQ(arrive(send(), 0b0100, 30), (std::vector<Told>{{2, Cycles{32}, true}}));
}

TEST_F(Requests, a_line_whose_data_has_come_is_asked_for_again_as_what_it_is_now) {
  add(0, 0, 7, 0b0011, Traffic::kNode);
  arrive(send(), 0b0011, 20);
  EXPECT_FALSE(add(20, 1, 7, 0b0011));
  ready = Cycles{0};
  EXPECT_TRUE(add(21, 1, 7, 0b0011, Traffic::kTriangle));
  EXPECT_EQ(ready, Cycles{0});
  EXPECT_EQ(uut.live(), 1u);
  expect_next(7, 0b0011, Traffic::kTriangle);
  EXPECT_EQ(arrive(send(), 0b0011, 60), (std::vector<Told>{{1, Cycles{61}, true}}));
  uut.clear();
}

TEST_F(Requests, those_told_may_ask_for_more_lines_than_the_table_has_held) {
  constexpr std::uint64_t kMore = 3000;
  add(0, 0, 7, 0b0001);
  add(0, 1, 7, 0b0001);
  add(0, 2, 7, 0b0010);
  const std::uint32_t token = send();
  std::vector<std::pair<std::uint32_t, bool>> told;
  SectorTimes times{};
  times.fill(Cycles{20});
  std::uint64_t line = 100;
  uut.arrived(token, 0b0011, times, [&](std::uint32_t lane, Cycles at, bool complete) {
    EXPECT_EQ(at, Cycles{20});
    told.emplace_back(lane, complete);
    for (std::uint64_t i = 0; i < kMore; ++i) {
      EXPECT_TRUE(add(20, lane, line++, 0b1000));
    }
  });
  EXPECT_EQ(told, (std::vector<std::pair<std::uint32_t, bool>>{{2, true}, {0, true}, {1, true}}));
  EXPECT_EQ(uut.live(), 3 * kMore);
  for (std::uint64_t i = 0; i < 3 * kMore; ++i) {
    expect_next(100 + i, 0b1000);
    const auto lane = std::array<std::uint32_t, 3>{2, 0, 1}[i / kMore];
    EXPECT_EQ(arrive(send(), 0b1000, 40), (std::vector<Told>{{lane, Cycles{43}, true}}));
  }
  EXPECT_EQ(uut.live(), 0u);
  EXPECT_TRUE(add(50, 5, 7, 0b0001));
  EXPECT_EQ(arrive(send(), 0b0001, 60), (std::vector<Told>{{5, Cycles{60}, true}}));
  uut.clear();
}

TEST_F(Requests, a_table_with_requests_under_way_is_not_forgotten) {
  add(0, 0, 7, 0b0001);
  EXPECT_THROW(uut.clear(), InternalError);
}

}  // namespace
}  // namespace a2rt::timing::test
