#include "a2rt/arith/multiplier.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "a2rt/base/error.h"

namespace a2rt::arith {

ApproxMultiplier::ApproxMultiplier(int magnitude_bits, int significand_bits, int columns,
                                   LowColumns mode)
    : magnitude_bits_(magnitude_bits),
      significand_bits_(significand_bits),
      columns_(columns),
      mode_(mode) {
  A2RT_CHECK(magnitude_bits >= 1 && magnitude_bits <= 15, "magnitude must have 1 to 15 bits");
  A2RT_CHECK(significand_bits >= 1 && significand_bits <= 24, "significand must have 1 to 24 bits");
  A2RT_CHECK(columns >= 0 && columns <= 8, "0 to 8 columns can be approximated");
  if (mutant(Mutant::kColumnsOffByOne)) {
    columns_ = std::min(columns + 1, 8);
  }
  std::uint32_t worst = 0;
  for (int c = 0; c < columns_; ++c) {
    // Pairs (i, c - i) with 0 <= i < p and 0 <= c - i < n.
    const int first = std::max(0, c - magnitude_bits + 1);
    const int height = std::max(0, std::min(c, significand_bits - 1) - first + 1);
    const int loss = mode == LowColumns::kDrop ? height : std::max(0, height - 1);
    worst += static_cast<std::uint32_t>(loss) << c;
    gate_ |= loss > 0 ? 1U << c : 0U;
  }
  carry_ = (worst + (1U << columns_) - 1) >> columns_;
  if (mutant(Mutant::kColumnsNoCarryCompensation)) {
    carry_ = 0;
  }
  if (mutant(Mutant::kColumnsCarryOneShort) && carry_ > 0) {
    --carry_;
  }
}

ApproxMultiplier::LowPart ApproxMultiplier::low_part(std::uint32_t magnitude,
                                                     std::uint32_t significand) const {
  LowPart low;
  const std::uint32_t kept = (1U << columns_) - 1;
  // Bits a column could hold given the operand widths: columns beyond row i's span get no bit.
  const std::uint32_t row_width = (1U << magnitude_bits_) - 1;
  low.and_bits = kept;
  const int rows = std::min(columns_, significand_bits_);
  std::uint32_t populated = 0;
  for (int i = 0; i < rows; ++i) {
    const std::uint32_t span = (row_width << i) & kept;
    const std::uint32_t row = (significand >> i & 1U) != 0 ? (magnitude << i) & span : 0U;
    low.exact += row;
    low.or_bits |= row;
    low.and_bits &= row | ~span;
    populated |= span;
  }
  low.and_bits &= populated;
  return low;
}

std::uint64_t ApproxMultiplier::low(std::uint32_t magnitude, std::uint32_t significand) const {
  const LowPart part = low_part(magnitude, significand);
  const std::uint64_t upper = static_cast<std::uint64_t>(magnitude) * significand - part.exact;
  if (mutant(Mutant::kColumnsAndBecomesOr) && mode_ == LowColumns::kCompress) {
    return upper + part.or_bits + carry_;
  }
  return mode_ == LowColumns::kDrop ? upper : upper + part.and_bits;
}

std::uint64_t ApproxMultiplier::high(std::uint32_t magnitude, std::uint32_t significand) const {
  const LowPart part = low_part(magnitude, significand);
  const std::uint64_t upper = static_cast<std::uint64_t>(magnitude) * significand - part.exact;
  const std::uint64_t carry =
      (part.or_bits & gate_) != 0 ? static_cast<std::uint64_t>(carry_) << columns_ : 0U;
  return upper + carry + (mode_ == LowColumns::kDrop ? 0U : part.or_bits);
}

IntFloatMultiplier::IntFloatMultiplier(const A2rtPrecision& precision)
    : core_(precision.magnitude_bits(), precision.direction.significand_bits,
            precision.multiplier_columns, precision.low_columns),
      format_(precision.direction),
      rounding_(precision.rounding) {}

namespace {

// product * 2^exponent, exact: the product has at most 40 bits and FP32's exponents are far from
// the ends of FP64's.
double scaled(std::uint64_t product, int exponent) {
  const auto power = static_cast<std::uint64_t>(exponent + 1023) << 52U;
  return static_cast<double>(product) * std::bit_cast<double>(power);
}

}  // namespace

float IntFloatMultiplier::near(std::uint32_t magnitude, float rate) const {
  if (magnitude == 0) {
    return 0;
  }
  if (std::isinf(rate)) {
    return rate;
  }
  const Significand m = split(rate, format_);
  const double product = scaled(core_.low(magnitude, m.integer), m.exponent);
  Rounding direction =
      rounding_ == QuantRounding::kNearest ? Rounding::kNearestEven : Rounding::kTowardZero;
  if (mutant(Mutant::kProductNearRoundsUp)) {
    direction = Rounding::kAwayFromZero;
  }
  const float rounded = round_to(product, format_, direction);
  return std::isinf(rounded) ? max_finite(format_) : rounded;
}

float IntFloatMultiplier::far(std::uint32_t magnitude, float rate) const {
  if (std::isinf(rate)) {
    return rate;
  }
  const Significand m = split(rate, format_);
  const double product = scaled(core_.high(magnitude, m.integer), m.exponent);
  Rounding direction =
      rounding_ == QuantRounding::kNearest ? Rounding::kNearestEven : Rounding::kAwayFromZero;
  if (mutant(Mutant::kProductFarTruncates)) {
    direction = Rounding::kTowardZero;
  }
  return round_to(product, format_, direction);
}

namespace {

// Accumulates |approximate - exact| / exact.
class ErrorSum {
 public:
  explicit ErrorSum(int significand_bits) : one_level_(std::ldexp(1.0, significand_bits - 1)) {}
  void add(double approximate, double exact) {
    const double error = std::fabs(approximate - exact);
    sum_ += error / exact;
    ++count_;
    result_.worst = std::max(result_.worst, error / exact);
    result_.worst_levels = std::max(result_.worst_levels, error / one_level_);
  }
  MultiplierError result() const {
    MultiplierError r = result_;
    r.mean = count_ == 0 ? 0 : sum_ / static_cast<double>(count_);
    return r;
  }

 private:
  double one_level_, sum_ = 0;
  std::uint64_t count_ = 0;
  MultiplierError result_;
};

}  // namespace

MultiplierErrors multiplier_errors(const ApproxMultiplier& multiplier, int magnitude_bits,
                                   int significand_bits, bool rounded) {
  const FloatFormat format = reduced_significand(significand_bits);
  ErrorSum low(significand_bits), high(significand_bits);
  for (std::uint32_t b = 1U << (significand_bits - 1); b < 1U << significand_bits; ++b) {
    for (std::uint32_t a = 1; a < 1U << magnitude_bits; ++a) {
      const double exact = static_cast<double>(a) * b;
      auto down = static_cast<double>(multiplier.low(a, b));
      auto up = static_cast<double>(multiplier.high(a, b));
      if (rounded) {
        down = round_to(down, format, Rounding::kTowardZero);
        up = round_to(up, format, Rounding::kAwayFromZero);
      }
      low.add(down, exact);
      high.add(up, exact);
    }
  }
  return {low.result(), high.result()};
}

}  // namespace a2rt::arith
