// Named faults that the mutation check (tests/unit/arith/mutation_test.cpp) switches on one at a
// time to prove that the property suite notices. In normal builds mutant() is constant false and
// the branches vanish.
#pragma once

namespace a2rt::arith {

enum class Mutant {
  kNone,
  kSubRoundsNearest,
  kMulRoundsNearest,
  kDivRoundsNearest,
  kResidualIgnored,
  kTruncateKeepsOneBitMore,
  kAwayForgetsSticky,
  kAwayAlwaysSteps,
  kOverflowTowardZeroGivesInf,
  kUnderflowFlushesAway,
  kColumnsAndBecomesOr,
  kColumnsNoCarryCompensation,
  kColumnsCarryOneShort,
  kColumnsOffByOne,
  kProductNearRoundsUp,
  kProductFarTruncates,
  kScaleRoundsUp,
  kScaleIgnoresExtentRounding,
  kBoxLoCeil,
  kBoxHiFloor,
  kBoxResidualIgnored,
  kDequantizeNearest,
  kShiftNotPadded,
  kSlabFarNotPadded,
  kSlabFarPadTooSmall,
  kSlabParallelDropsFace,
  kSlabNearOverflowStays,
  kOriginNoErrorBound,
  kOriginBoundForgetsShift,
  kOriginMinTruncates,
  kOriginMaxFloor,
  kOriginClampedNotEscaped,
  kReciprocalNotPadded,
  kReciprocalSwapped,
  kTinyRateBecomesParallel,
  kHugeRateKeepsZero,
  kLeftRoundsDown,
  kLeftShortCutTruncates,
  kLeftShortCutAlways,
  kQBoxUsesWrongOriginBound,
  kQBoxNegativeDirectionSwapsPlanes,
  kQBoxStrictCompare,
  kGuardOffsetForgotten,
  kPow2ExponentOneShort,
  kPow2LoRoundsUp,
  kCount
};

#if defined(A2RT_MUTATION)
inline Mutant active_mutant = Mutant::kNone;
inline bool mutant(Mutant m) { return active_mutant == m; }
#else
constexpr bool mutant(Mutant) { return false; }
#endif

}  // namespace a2rt::arith
