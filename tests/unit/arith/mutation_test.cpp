// Mutation check: every named fault of mutate.h, switched on alone, must be noticed by at least
// one property. This executable compiles the arithmetic again with A2RT_MUTATION.
#include <gtest/gtest.h>

#include <map>

#include "a2rt/arith/mutate.h"
#include "properties.h"

#if !defined(A2RT_MUTATION)
#error "mutation_test.cpp and the arithmetic must be compiled with A2RT_MUTATION"
#endif

namespace a2rt::arith::testing {
namespace {

struct NamedMutant {
  Mutant mutant;
  const char* name;
};

#define A2RT_NAME(mutant) \
  NamedMutant { Mutant::mutant, #mutant }
constexpr NamedMutant kMutants[] = {
    A2RT_NAME(kSubRoundsNearest),
    A2RT_NAME(kMulRoundsNearest),
    A2RT_NAME(kDivRoundsNearest),
    A2RT_NAME(kResidualIgnored),
    A2RT_NAME(kTruncateKeepsOneBitMore),
    A2RT_NAME(kAwayForgetsSticky),
    A2RT_NAME(kAwayAlwaysSteps),
    A2RT_NAME(kOverflowTowardZeroGivesInf),
    A2RT_NAME(kUnderflowFlushesAway),
    A2RT_NAME(kColumnsAndBecomesOr),
    A2RT_NAME(kColumnsNoCarryCompensation),
    A2RT_NAME(kColumnsCarryOneShort),
    A2RT_NAME(kColumnsOffByOne),
    A2RT_NAME(kProductNearRoundsUp),
    A2RT_NAME(kProductFarTruncates),
    A2RT_NAME(kScaleRoundsUp),
    A2RT_NAME(kScaleIgnoresExtentRounding),
    A2RT_NAME(kBoxLoCeil),
    A2RT_NAME(kBoxHiFloor),
    A2RT_NAME(kBoxResidualIgnored),
    A2RT_NAME(kDequantizeNearest),
    A2RT_NAME(kShiftNotPadded),
    A2RT_NAME(kSlabFarNotPadded),
    A2RT_NAME(kSlabFarPadTooSmall),
    A2RT_NAME(kSlabParallelDropsFace),
    A2RT_NAME(kSlabNearOverflowStays),
    A2RT_NAME(kOriginNoErrorBound),
    A2RT_NAME(kOriginBoundForgetsShift),
    A2RT_NAME(kOriginMinTruncates),
    A2RT_NAME(kOriginMaxFloor),
    A2RT_NAME(kOriginClampedNotEscaped),
    A2RT_NAME(kReciprocalNotPadded),
    A2RT_NAME(kReciprocalSwapped),
    A2RT_NAME(kTinyRateBecomesParallel),
    A2RT_NAME(kHugeRateKeepsZero),
    A2RT_NAME(kLeftRoundsDown),
    A2RT_NAME(kLeftShortCutTruncates),
    A2RT_NAME(kLeftShortCutAlways),
    A2RT_NAME(kQBoxUsesWrongOriginBound),
    A2RT_NAME(kQBoxNegativeDirectionSwapsPlanes),
    A2RT_NAME(kQBoxStrictCompare),
    A2RT_NAME(kGuardOffsetForgotten),
    A2RT_NAME(kPow2ExponentOneShort),
    A2RT_NAME(kPow2LoRoundsUp),
};
#undef A2RT_NAME
static_assert(std::size(kMutants) + 1 == static_cast<std::size_t>(Mutant::kCount),
              "every mutant of mutate.h must be listed");

constexpr std::uint64_t kSeed = 7;
constexpr std::uint64_t kCases = 120'000;

class ActiveMutant {
 public:
  explicit ActiveMutant(Mutant m) { active_mutant = m; }
  ~ActiveMutant() { active_mutant = Mutant::kNone; }
  ActiveMutant(const ActiveMutant&) = delete;
  ActiveMutant& operator=(const ActiveMutant&) = delete;
};

// The property that notices the active mutant, with the case; empty if none does. Short rounds come
// first: most mutants die within a few cases of a late property.
std::string killer() {
  for (const std::uint64_t cases : {kCases / 100, kCases}) {
    for (const Property& property : all_properties()) {
      const PropertyResult result = property.check(kSeed, cases, true);
      if (result.failures > 0) {
        return property.name + " after " + std::to_string(result.checks) + " checks (" +
               result.first + ")";
      }
    }
  }
  return "";
}

TEST(MutationBaseline, NoPropertyFailsWithoutAMutant) {
  const ActiveMutant none(Mutant::kNone);
  EXPECT_EQ(killer(), "");
}

class Mutation : public ::testing::TestWithParam<NamedMutant> {};

TEST_P(Mutation, IsKilled) {
  const ActiveMutant active(GetParam().mutant);
  const std::string by = killer();
  EXPECT_NE(by, "") << GetParam().name << " survived: no property notices it";
  std::printf("%s killed by %s\n", GetParam().name, by.c_str());
}

INSTANTIATE_TEST_SUITE_P(Arith, Mutation, ::testing::ValuesIn(kMutants),
                         [](const auto& instance) { return std::string(instance.param.name + 1); });

}  // namespace
}  // namespace a2rt::arith::testing
