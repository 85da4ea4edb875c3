#include "a2rt/timing/in_flight.h"

#include <gtest/gtest.h>

namespace a2rt::timing {
namespace {

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
