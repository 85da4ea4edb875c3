#include "a2rt/energy/qbox_area.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>

#include "a2rt/arith/multiplier.h"

namespace a2rt::energy {
namespace {

constexpr double kGate = 1, kXor = 2, kMux = 3, kHalfAdder = 3, kFullAdder = 7;
constexpr int kAxes = 3;
// max(0, x, y, z) and min(left, x, y, z) are three two-input selections each.
constexpr int kSelections = 6;

int ceil_log2(int n) { return static_cast<int>(std::bit_width(static_cast<unsigned>(n - 1))); }

// |plane - origin|: a subtractor of one bit more than the magnitude, then conditional inversion.
double subtractor(int magnitude_bits) {
  const int width = magnitude_bits + 1;
  return width * kFullAdder + magnitude_bits * (kXor + kHalfAdder);
}

// Bits of the partial products in column c of an n x p array.
int height(int column, int n, int p) { return std::min({column + 1, n, p, n + p - 1 - column}); }

// Every full adder takes one bit away, until one bit a column is left; the final carry chain is
// part of that count. `far`: the tmax path with its carry compensation.
double multiplier(const arith::A2rtPrecision& precision, bool far) {
  const int n = precision.magnitude_bits(), p = precision.direction.significand_bits;
  const int k = std::min(precision.multiplier_columns, n + p - 1);
  const bool compressed = precision.low_columns == arith::LowColumns::kCompress;
  int exact_bits = 0, low_gates = 0;
  for (int c = 0; c < n + p - 1; ++c) {
    const int bits = height(c, n, p);
    if (c >= k) {
      exact_bits += bits;
    } else if (compressed) {
      low_gates += bits - 1;  // one AND or OR tree
    } else if (far) {
      low_gates += bits;  // only whether any bit is set
    }
  }
  const int array_gates = compressed || far ? n * p : exact_bits;
  int constant_bits = 0;
  if (far && k > 0) {
    const arith::ApproxMultiplier model(n, p, k, precision.low_columns);
    constant_bits = std::popcount(model.carry_compensation());
    low_gates += k;  // does any column ask for the compensation?
  }
  const int adders = std::max(0, exact_bits + constant_bits - (n + p - k));
  return array_gates * kGate + low_gates * kGate + adders * kFullAdder;
}

// Leading-one detector and shifter over the product, exponent adjustment, rounding up where the
// path rounds up (both do to nearest).
double normaliser(const arith::A2rtPrecision& precision, bool far) {
  const int n = precision.magnitude_bits(), p = precision.direction.significand_bits;
  const int product = n + p;
  const bool rounds = far || precision.rounding == arith::QuantRounding::kNearest;
  return product * 2 * kGate + ceil_log2(n + 1) * p * kMux +
         precision.direction.exponent_bits * kFullAdder + (rounds ? p * kHalfAdder : 0);
}

// An integer-like comparison of two floats: an XNOR and two gates a bit.
double comparator(int bits) { return bits * (kXor + 2 * kGate); }

}  // namespace

QBoxGates qbox_gates(const arith::A2rtPrecision& precision) {
  QBoxGates gates;
  gates.subtract = 2 * kAxes * subtractor(precision.magnitude_bits());
  gates.multiply = kAxes * (multiplier(precision, false) + multiplier(precision, true));
  gates.normalise = kAxes * (normaliser(precision, false) + normaliser(precision, true));
  const int bits = precision.direction.bits();
  gates.compare = kSelections * (comparator(bits) + bits * kMux) + comparator(bits);
  return gates;
}

arith::A2rtPrecision published_precision() {
  arith::A2rtPrecision precision;
  precision.origin = arith::OriginDesign::kLiteral;
  return precision;
}

double qbox_scale(const arith::A2rtPrecision& precision) {
  return qbox_gates(precision).total() / qbox_gates(published_precision()).total();
}

EnergyTable for_precision(const EnergyTable& table, const arith::A2rtPrecision& precision) {
  const double scale = qbox_scale(precision);
  return scale == 1 ? table : table.scaled("qbox_a2rt", scale, "scaled by unit gates");
}

}  // namespace a2rt::energy
