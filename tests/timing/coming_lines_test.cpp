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
  EXPECT_EQ(uut.obtain(Cycles{0}, 7).coming(Cycles{0}, 0xf), 0);
}

TEST(ComingLines, sectors_come_until_the_last_of_them_is_there) {
  ComingLines uut(4);
  uut.obtain(Cycles{10}, 7).add(Cycles{10}, 0b0001, Cycles{50});
  uut.obtain(Cycles{20}, 7).add(Cycles{20}, 0b0100, Cycles{40});
  EXPECT_EQ(uut.find(7)->coming(Cycles{49}, 0b1111), 0b0101);
  EXPECT_EQ(uut.find(7)->coming(Cycles{49}, 0b0110), 0b0100);
  EXPECT_EQ(uut.find(7)->there(), Cycles{50});
  EXPECT_EQ(uut.find(7)->coming(Cycles{50}, 0b1111), 0);
}

TEST(ComingLines, what_is_there_is_not_on_its_way_with_what_comes_next) {
  ComingLines uut(4);
  uut.obtain(Cycles{10}, 7).add(Cycles{10}, 0b0001, Cycles{50});
  uut.obtain(Cycles{50}, 7).add(Cycles{50}, 0b0010, Cycles{90});
  EXPECT_EQ(uut.find(7)->coming(Cycles{60}, 0b1111), 0b0010);
}

// Few buckets and many lines on their way: most do not find room in the table.
TEST(ComingLines, nothing_on_its_way_is_forgotten_or_made_up_however_small_the_table) {
  for (const std::size_t lines : {4u, 64u, 1024u}) {
    ComingLines uut(lines);
    struct Known {
      SectorMask sectors = 0;
      Cycles there;
    };
    std::map<std::uint64_t, Known> all;
    std::mt19937_64 random(3);
    int known = 0;
    for (std::uint64_t now = 0; now < 20'000; ++now) {
      const std::uint64_t line = random() % 300;
      const auto sectors = static_cast<SectorMask>(1 + random() % 15);
      const Cycles at{now}, there{now + 20 + random() % 400};
      Known& k = all[line];
      k = k.there > at ? k : Known{};
      const ComingLines::Line* found = uut.find(line);
      ASSERT_EQ(found == nullptr ? 0 : found->coming(at, 0xf), k.sectors) << now;
      ComingLines::Line& said = uut.obtain(at, line);
      ASSERT_EQ(said.coming(at, 0xf), k.sectors) << now;
      if (k.sectors != 0) {
        ASSERT_EQ(said.there(), k.there) << now;
        ++known;
      }
      said.add(at, sectors, there);
      k = {static_cast<SectorMask>(k.sectors | sectors), std::max(k.there, there)};
    }
    EXPECT_GT(known, 5000);
  }
}

}  // namespace
}  // namespace a2rt::timing
