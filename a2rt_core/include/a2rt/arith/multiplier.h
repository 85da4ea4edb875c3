// The INT x FLOAT approximate multiplier of the quantized tester, bit for bit (paper section IV.A
// item 3; a2rt-numerics section 5).
//
// Operands: an unsigned magnitude A of n bits a[0..n-1] (|plane - origin|) and the significand B of
// p bits b[0..p-1] (hidden bit included) of the inverse rate m = B * 2^e.
//
// 1. Partial products: x(i,j) = b[i] AND a[j], i < p, j < n, in column i + j. Column c has height
//    h(c) = number of pairs (i,j) with i + j = c.
// 2. Columns c >= k: exact compressors; they contribute U = sum of x(i,j) * 2^(i+j), i + j >= k.
// 3. Columns c < k (k = 0 leaves none), mode "compress":
//      tmin path: column c yields the single bit AND of its h(c) bits; no carries.
//      tmax path: column c yields the single bit OR of its h(c) bits; no carries; and if any column
//                 c < k with h(c) >= 2 has a bit set, the constant K is added at column k, where
//                 K = ceil( sum over c < k of (h(c) - 1) * 2^c  /  2^k ).
//    Mode "drop":
//      tmin path: nothing.
//      tmax path: if any bit of any column c < k is set, K is added at column k, where
//                 K = ceil( sum over c < k of h(c) * 2^c / 2^k ).
// 4. P = U + the low part. The product's value is P * 2^e, normalised to the direction format:
//    towards zero on the tmin path, away from zero on the tmax path (to nearest in the "nearest"
//    design). P = 0 gives 0.
//
// Bounds (checked by exhaustion in tests/unit/arith/multiplier_test.cpp):
//   tmin path <= A*B: an AND is at most the sum of its inputs; dropping only lowers.
//   tmax path >= A*B: a column of h bits holding s ones has sum s <= OR + (h - 1) and, with s = 0,
//   loses nothing. If no column of height >= 2 has a bit, nothing is lost at all; otherwise
//   K * 2^k is at least the sum of all columns' worst losses.
// Normalisation cannot underflow: P * 2^e is a multiple of 2^e, which for a normal or denormal m of
// the format is a multiple of the smallest denormal.
#pragma once

#include <cstdint>

#include "a2rt/arith/precision.h"

namespace a2rt::arith {

// Integer core. magnitude_bits 1..15, significand_bits 1..24, columns 0..8.
class ApproxMultiplier {
 public:
  // Throws InternalError if a parameter is out of range.
  ApproxMultiplier(int magnitude_bits, int significand_bits, int columns,
                   LowColumns mode = LowColumns::kCompress);

  // P of the tmin path (<= exact) and of the tmax path (>= exact).
  std::uint64_t low(std::uint32_t magnitude, std::uint32_t significand) const;
  std::uint64_t high(std::uint32_t magnitude, std::uint32_t significand) const;

  int columns() const { return columns_; }
  LowColumns mode() const { return mode_; }
  // The constant K of step 3.
  std::uint32_t carry_compensation() const { return carry_; }

 private:
  // Bits of the dropped columns: exact sum, column-wise AND, column-wise OR.
  struct LowPart {
    std::uint64_t exact = 0;
    std::uint32_t and_bits = 0, or_bits = 0;
  };
  LowPart low_part(std::uint32_t magnitude, std::uint32_t significand) const;

  int magnitude_bits_, significand_bits_, columns_;
  LowColumns mode_;
  std::uint32_t carry_ = 0;
  std::uint32_t gate_ = 0;  // columns whose OR bit triggers the compensation
};

// INT x FLOAT products in a direction format. `rate` must be a non-negative number of the format.
// near: magnitude * rate, never above; overflow gives the largest finite number.
// far : never below; overflow gives infinity.
// An infinite rate marks a ray parallel to the slab (or nearly so): magnitude > 0 gives +inf.
// For magnitude 0 near is 0 and far is +inf (no constraint).
class IntFloatMultiplier {
 public:
  explicit IntFloatMultiplier(const A2rtPrecision& precision);
  float near(std::uint32_t magnitude, float rate) const;
  float far(std::uint32_t magnitude, float rate) const;
  const ApproxMultiplier& core() const { return core_; }

 private:
  ApproxMultiplier core_;
  FloatFormat format_;
  QuantRounding rounding_;
};

// Error of one multiplier over all operands, relative to the exact product.
struct MultiplierError {
  double worst = 0, mean = 0;
  double worst_levels = 0;  // |error| / 2^(p-1): in quantization levels of t
};
struct MultiplierErrors {
  MultiplierError low, high;
};
// Exhausts all magnitudes >= 1 and all normalised significands. `rounded`: after normalisation to
// significand_bits, otherwise of P itself.
MultiplierErrors multiplier_errors(const ApproxMultiplier& multiplier, int magnitude_bits,
                                   int significand_bits, bool rounded);

}  // namespace a2rt::arith
