// What both tiers demand of a guarantee run.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "a2rt/hard/guarantee.h"

namespace a2rt::arith::testing {

using namespace a2rt::hard;

inline void expect_guarantee(const GuaranteeResult& result, std::uint64_t least_tests) {
  // Kept in the test's folder: `a2rt test --tier slow` shows it.
  const std::string table = text_of(table_of(result));
  std::ofstream("guarantee-" + std::to_string(least_tests) + ".txt") << table;
  std::printf("%s", table.c_str());
  for (std::size_t d = 0; d < kDesigns; ++d) {
    const auto design = static_cast<Design>(d);
    const Counts all = result.total(design);
    std::printf(
        "summary: %s: %llu quantized box tests against exact arithmetic, %llu missed hits\n",
        name_of(design).c_str(), static_cast<unsigned long long>(all.tests),
        static_cast<unsigned long long>(all.lost()));
    if (!claims_no_miss(design)) {
      continue;
    }
    EXPECT_GE(all.tests, least_tests) << name_of(design);
    EXPECT_GT(all.hits, all.tests / 100) << name_of(design);
    EXPECT_EQ(all.missed, 0U) << name_of(design) << ": " << all.first_missed;
    EXPECT_EQ(all.escaped_missed, 0U) << name_of(design) << ": " << all.first_missed;
    EXPECT_EQ(all.group_missed, 0U) << name_of(design) << ": " << all.first_missed;
  }
  // The designs that can miss do miss on these cases; otherwise the cases are too tame.
  EXPECT_GT(result.total(Design::kLiteral).missed, 0U);
  EXPECT_GT(result.total(Design::kNearest).missed, 0U);
  EXPECT_GT(result.total(Design::kAqb8Floor).missed, 0U);
}

}  // namespace a2rt::arith::testing
