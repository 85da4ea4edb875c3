// Every promise of arith/ over seeded, stratified cases, against exact rationals.
#include <gtest/gtest.h>

#include "properties.h"

namespace a2rt::arith::testing {
namespace {

class Properties : public ::testing::TestWithParam<Property> {};

TEST_P(Properties, Holds) {
  constexpr std::uint64_t kCases = 120'000;
  const PropertyResult result = GetParam().check(20260101, kCases, false);
  EXPECT_EQ(result.failures, 0U) << result.first;
  EXPECT_GT(result.checks, kCases / 4) << "too few cases reached the check";
  RecordProperty("checks", static_cast<int>(result.checks));
}

INSTANTIATE_TEST_SUITE_P(Arith, Properties, ::testing::ValuesIn(all_properties()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace a2rt::arith::testing
