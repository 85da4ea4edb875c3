// Lines on their way, and limits on what is under way, against tables that forget nothing.
#include "a2rt/timing/coming_lines.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace a2rt::timing {
namespace {

TEST(ComingLines, nothing_is_known_of_a_line_before_it_is_asked_for) {
  ComingLines uut(4);
  EXPECT_EQ(uut.find(7), nullptr);
  EXPECT_EQ(uut.obtain(7).coming(Cycles{0}, 0xf), 0);
}

TEST(ComingLines, sectors_come_until_the_last_of_them_is_there) {
  ComingLines uut(4);
  uut.obtain(7).add(Cycles{10}, 0b0001, Cycles{50});
  uut.obtain(7).add(Cycles{20}, 0b0100, Cycles{40});
  EXPECT_EQ(uut.find(7)->coming(Cycles{49}, 0b1111), 0b0101);
  EXPECT_EQ(uut.find(7)->coming(Cycles{49}, 0b0110), 0b0100);
  EXPECT_EQ(uut.find(7)->there(), Cycles{50});
  EXPECT_EQ(uut.find(7)->coming(Cycles{50}, 0b1111), 0);
}

TEST(ComingLines, what_is_there_is_not_on_its_way_with_what_comes_next) {
  ComingLines uut(4);
  uut.obtain(7).add(Cycles{10}, 0b0001, Cycles{50});
  uut.obtain(7).add(Cycles{50}, 0b0010, Cycles{90});
  EXPECT_EQ(uut.find(7)->coming(Cycles{60}, 0b1111), 0b0010);
}

TEST(ComingLines, of_a_full_bucket_the_line_that_is_there_first_makes_room) {
  ComingLines uut(4);
  std::vector<std::uint64_t> together;  // lines of one bucket
  for (std::uint64_t line = 0; together.size() < 3; ++line) {
    if (mixed(line) >> 63 == 0) {
      together.push_back(line);
    }
  }
  uut.obtain(together[0]).add(Cycles{0}, 1, Cycles{90});
  uut.obtain(together[1]).add(Cycles{0}, 1, Cycles{80});
  uut.obtain(together[2]).add(Cycles{0}, 1, Cycles{70});
  EXPECT_NE(uut.find(together[0]), nullptr);
  EXPECT_EQ(uut.find(together[1]), nullptr);
  EXPECT_EQ(uut.find(together[2])->there(), Cycles{70});
}

// Whatever it says of a line is true; with room enough it says all.
TEST(ComingLines, never_promise_what_was_not_asked_for_and_forget_little_with_room) {
  ComingLines uut(256);
  struct Known {
    SectorMask sectors = 0;
    Cycles there;
  };
  std::map<std::uint64_t, Known> all;
  std::mt19937_64 random(3);
  int known = 0, forgotten = 0;
  for (std::uint64_t now = 0; now < 50'000; ++now) {
    const std::uint64_t line = random() % 4000;
    const auto sectors = static_cast<SectorMask>(1 + random() % 15);
    const Cycles at{now}, there{now + 20 + random() % 40};
    Known& k = all[line];
    k = k.there > at ? k : Known{};
    ComingLines::Line& said = uut.obtain(line);
    const SectorMask coming = said.coming(at, 0xf);
    if (coming != 0) {
      ASSERT_EQ(coming & ~k.sectors, 0);
      ASSERT_LE(said.there(), k.there);
    }
    known += k.sectors != 0;
    forgotten += k.sectors != coming;
    said.add(at, sectors, there);
    k = {static_cast<SectorMask>(k.sectors | sectors), std::max(k.there, there)};
  }
  EXPECT_GT(known, 400);
  EXPECT_LT(forgotten, known / 4);
}

TEST(InFlight, one_more_begins_when_the_one_so_many_before_has_ended) {
  InFlight uut(3);
  EXPECT_EQ(uut.begin(Cycles{5}, 3), Cycles{5});
  uut.add(2, Cycles{100});
  uut.add(1, Cycles{60});
  EXPECT_EQ(uut.begin(Cycles{5}, 1), Cycles{100});
  uut.add(2, Cycles{200});
  EXPECT_EQ(uut.begin(Cycles{5}, 1), Cycles{60});
  EXPECT_EQ(uut.begin(Cycles{5}, 2), Cycles{200});
  EXPECT_EQ(uut.begin(Cycles{300}, 1), Cycles{300});
}

}  // namespace
}  // namespace a2rt::timing
