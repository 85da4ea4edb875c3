#include "a2rt/timing/arrival.h"

#include <gtest/gtest.h>

namespace a2rt::timing {
namespace {

TEST(Arrival, nothing_is_on_its_way_at_first) {
  EXPECT_EQ(Arrival().after(Cycles{0}, 0).sectors(), 0);
}

TEST(Arrival, sectors_are_on_their_way_until_they_are_there) {
  const Arrival uut = Arrival().with(5, 0b0110, Cycles{100});
  EXPECT_EQ(uut.after(Cycles{99}, 5).sectors(), 0b0110);
  EXPECT_EQ(uut.after(Cycles{99}, 5).there(), Cycles{100});
  EXPECT_EQ(uut.after(Cycles{100}, 5).sectors(), 0);
}

TEST(Arrival, what_comes_to_one_receiver_is_not_on_its_way_to_another) {
  for (std::uint32_t receiver = 0; receiver < Arrival::kReceivers; ++receiver) {
    const Arrival uut = Arrival().with(receiver, 0b1111, Cycles{100});
    for (std::uint32_t other = 0; other < Arrival::kReceivers; ++other) {
      EXPECT_EQ(uut.after(Cycles{1}, other).sectors(), other == receiver ? 0b1111 : 0);
    }
  }
}

TEST(Arrival, more_sectors_make_all_of_them_wait_for_the_last) {
  const Arrival first = Arrival().with(63, 0b0001, Cycles{100});
  EXPECT_EQ(first.with(63, 0b1000, Cycles{70}).there(), Cycles{100});
  const Arrival both = first.with(63, 0b1000, Cycles{300});
  EXPECT_EQ(both.there(), Cycles{300});
  EXPECT_EQ(both.after(Cycles{200}, 63).sectors(), 0b1001);
}

TEST(Arrival, times_up_to_two_to_the_fifty_four_are_kept) {
  const Cycles last{(std::uint64_t{1} << 54) - 1};
  EXPECT_EQ(Arrival().with(63, 0b1111, last).there(), last);
}

}  // namespace
}  // namespace a2rt::timing
