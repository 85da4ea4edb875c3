// The guarantee, stratified sample (fast tier).
#include "guarantee_checks.h"

namespace a2rt::arith::testing {
namespace {

TEST(Guarantee, NoConservativeDesignMissesInAStratifiedSample) {
  constexpr std::uint64_t kTests = 10'000'000;
  expect_guarantee(run_guarantee(kTests, 2, 1), kTests);
}

}  // namespace
}  // namespace a2rt::arith::testing
