// The guarantee over a thousand million tests per conservative design (slow tier).
#include "guarantee_checks.h"

namespace a2rt::arith::testing {
namespace {

TEST(Guarantee, NoConservativeDesignMissesInAThousandMillionTests) {
  constexpr std::uint64_t kTests = 1'000'000'000;
  expect_guarantee(run_guarantee(kTests, 2, 424242), kTests);
}

}  // namespace
}  // namespace a2rt::arith::testing
