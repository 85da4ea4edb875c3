// The calendar and the budgets everything else stands on.
#include "a2rt/timing/calendar.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "a2rt/timing/attribution.h"
#include "mocks.h"

namespace a2rt::timing::test {
namespace {

// Notes what it was woken with and when.
class RecordingComponent final : public Component {
 public:
  struct Wakeup {
    Cycles when;
    std::uint32_t what, value;
  };
  void wake(Cycles now, std::uint32_t what, std::uint32_t value) override {
    wakeups.push_back({now, what, value});
  }
  std::string dump() const override { return "recording component\n"; }
  void check_drained() const override {}
  std::vector<Wakeup> wakeups;
};

TEST(Calendar, keeps_appointments_in_order_of_time_then_of_making) {
  Calendar uut;
  RecordingComponent client;
  uut.at(Cycles{5000}, client, 0, 4);  // beyond the wheel
  uut.at(Cycles{7}, client, 0, 2);
  uut.at(Cycles{3}, client, 0, 1);
  uut.at(Cycles{7}, client, 0, 3);
  uut.at(Cycles{1'000'000}, client, 0, 5);
  EXPECT_EQ(drain(uut), Cycles{1'000'000});
  ASSERT_EQ(client.wakeups.size(), 5u);
  for (std::uint32_t i = 0; i < 5; ++i) {
    EXPECT_EQ(client.wakeups[i].value, i + 1);
  }
  EXPECT_EQ(client.wakeups[3].when, Cycles{5000});
}

TEST(Calendar, an_appointment_exactly_one_wheel_ahead_is_kept_on_time) {
  for (const std::uint64_t ahead : {1023u, 1024u, 1025u, 2048u}) {
    Calendar uut;
    RecordingComponent client;
    At start(uut, Cycles{77}, [&](Cycles now) { uut.at(now + Cycles{ahead}, client, 0, 0); });
    drain(uut);
    ASSERT_EQ(client.wakeups.size(), 1u);
    EXPECT_EQ(client.wakeups[0].when, Cycles{77 + ahead});
  }
}

TEST(Calendar, numbers_come_in_order_of_time_then_of_making_and_before_what_else_there_is) {
  Calendar uut;
  RecordingComponent client;
  uut.number(client, 9, 100);
  uut.at(Cycles{7}, client, 0, 1000);
  uut.at(Cycles{7}, 42);
  uut.at(Cycles{7}, 0);
  uut.at(Cycles{7}, 99);
  uut.at(Cycles{3}, 17);
  uut.at(Cycles{5000}, 3);  // beyond the wheel
  EXPECT_EQ(drain(uut), Cycles{5000});
  std::vector<std::uint32_t> values;
  for (const auto& w : client.wakeups) {
    EXPECT_EQ(w.what, w.value == 1000 ? 0u : 9u);
    values.push_back(w.value);
  }
  EXPECT_EQ(values, (std::vector<std::uint32_t>{17, 42, 0, 99, 1000, 3}));
}

TEST(Calendar, a_number_may_be_appointed_again_while_it_is_kept) {
  // Each comes again after its number of cycles, ten times.
  struct Again final : Component {
    explicit Again(Calendar& c) : calendar(c) {}
    void wake(Cycles now, std::uint32_t, std::uint32_t value) override {
      kept.emplace_back(now.value, value);
      if (++times[value] < 10) {
        calendar.at(now + Cycles{value}, value);
      }
    }
    std::string dump() const override { return "again\n"; }
    void check_drained() const override {}
    Calendar& calendar;
    std::map<std::uint32_t, int> times;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> kept;
  };
  Calendar uut;
  Again client(uut);
  uut.number(client, 0, 2000);
  for (const std::uint32_t n : {1u, 2u, 3u, 64u, 1023u, 1024u, 1999u}) {
    uut.at(Cycles{n}, n);
  }
  drain(uut);
  EXPECT_EQ(client.kept.size(), 70u);
  EXPECT_TRUE(std::is_sorted(client.kept.begin(), client.kept.end(),
                             [](const auto& a, const auto& b) { return a.first < b.first; }));
  std::map<std::uint32_t, std::uint64_t> last;
  for (const auto& [when, value] : client.kept) {
    EXPECT_EQ(when, last[value] += value);
  }
}

TEST(Calendar, a_number_is_not_appointed_for_the_present) {
  Calendar uut;
  RecordingComponent client;
  uut.number(client, 0, 8);
  At now(uut, Cycles{9}, [&](Cycles n) { EXPECT_THROW(uut.at(n, 3), InternalError); });
  drain(uut);
}

TEST(Calendar, an_appointment_made_for_the_running_cycle_is_kept_in_it) {
  Calendar uut;
  RecordingComponent client;
  At now(uut, Cycles{9}, [&](Cycles n) { uut.at(n, client, 0, 0); });
  EXPECT_EQ(drain(uut), Cycles{9});
  EXPECT_EQ(client.wakeups.size(), 1u);
}

TEST(Calendar, refuses_an_appointment_in_the_past) {
  Calendar uut;
  RecordingComponent client;
  At late(uut, Cycles{9},
          [&](Cycles) { EXPECT_THROW(uut.at(Cycles{8}, client, 0, 0), InternalError); });
  drain(uut);
}

TEST(Attribution, a_cycle_left_out_or_booked_beyond_the_end_fails_the_check) {
  Attribution<RtReason> uut;
  uut.until(Cycles{10}, RtReason::kTest);
  EXPECT_NO_THROW(uut.check(Cycles{10}));
  EXPECT_THROW(uut.check(Cycles{11}), InternalError);
  EXPECT_THROW(uut.check(Cycles{9}), InternalError);
}

TEST(BusyCycles, counts_the_union_of_intervals_in_any_order) {
  BusyCycles uut;
  uut.mark(Cycles{10}, Cycles{20});
  uut.mark(Cycles{5}, Cycles{12});
  uut.mark(Cycles{30}, Cycles{140});
  EXPECT_EQ(uut.take(Cycles{8}), 3u);
  EXPECT_EQ(uut.take(Cycles{35}), 12u + 5u);
  uut.mark(Cycles{20}, Cycles{40});  // its past is taken already
  EXPECT_EQ(uut.take(Cycles{200}), 105u);
  EXPECT_EQ(uut.take(Cycles{9000}), 0u);
}

TEST(BusyCycles, an_interval_longer_than_its_window_counts_once) {
  BusyCycles uut;
  uut.mark(Cycles{10}, Cycles{1'000'000});
  uut.mark(Cycles{20}, Cycles{30});
  EXPECT_EQ(uut.take(Cycles{25}), 15u);
  EXPECT_EQ(uut.take(Cycles{2'000'000}), 1'000'000u - 25u);
  uut.mark(Cycles{2'000'005}, Cycles{2'000'010});
  EXPECT_EQ(uut.take(Cycles{2'000'020}), 5u);
}

TEST(BinnedSeries, means_survive_the_doubling_of_its_bins) {
  BinnedSeries uut(4);
  uut.add(Cycles{0}, Cycles{128}, 8);
  uut.add(Cycles{128}, Cycles{2048}, 2);
  EXPECT_EQ(uut.width(), 512u);
  const std::vector<double> means = uut.means(Cycles{2048});
  ASSERT_EQ(means.size(), 4u);
  EXPECT_DOUBLE_EQ(means[0], (128 * 8 + 384 * 2) / 512.0);
  EXPECT_DOUBLE_EQ(means[3], 2);
}

}  // namespace
}  // namespace a2rt::timing::test
