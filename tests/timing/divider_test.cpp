// Division by multiplication, against division.
#include "a2rt/timing/divider.h"

#include <gtest/gtest.h>

#include <random>

namespace a2rt::timing::test {
namespace {

class AnyDivisor : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(AnyDivisor, quotient_and_rest_are_those_of_a_division) {
  const std::uint64_t by = GetParam();
  const Divider uut(by);
  std::mt19937_64 random(by);
  for (int i = 0; i < 10000; ++i) {
    const std::uint64_t any = random() >> random() % 64;
    // Multiples and their neighbours are where a quotient would be off first.
    for (const std::uint64_t number : {any, any / by * by, any / by * by - 1, ~any}) {
      const auto [quotient, rest] = uut.divide(number);
      ASSERT_EQ(quotient, number / by) << number;
      ASSERT_EQ(rest, number % by) << number;
    }
  }
}

TEST_P(AnyDivisor, quotients_are_right_on_both_sides_of_where_multiplication_is_given_up) {
  const std::uint64_t by = GetParam(), last = ~std::uint64_t{0} / by;
  const Divider uut(by);
  for (const std::uint64_t around : {last, last / by * by, std::uint64_t{0}, ~std::uint64_t{0}}) {
    for (std::uint64_t i = 0; i < 7; ++i) {
      const std::uint64_t number = around + i - 3;  // wraps around
      ASSERT_EQ(uut.quotient(number), number / by) << number;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Divisors, AnyDivisor,
                         ::testing::Values(1, 2, 3, 7, 24, 256, 1000, 2048, 1'000'000,
                                           (std::uint64_t{1} << 32) + 1,
                                           (std::uint64_t{1} << 40) - 1, ~std::uint64_t{0}));

}  // namespace
}  // namespace a2rt::timing::test
