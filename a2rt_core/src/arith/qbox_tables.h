// What the QBOX kernels need: the reference multiplier, masks of the direction format, and the
// approximate multiplier as a correction to the exact product.
//
// The columns below k involve only the k lowest bits of the magnitude, so for a given significand
// the difference between approximate and exact product is a function of magnitude mod 2^k: a table
// row per significand. With k <= 4 a row has 16 bytes and is looked up by a byte shuffle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "a2rt/arith/qbox.h"

namespace a2rt::arith {

struct QBoxTester::Tables {
  explicit Tables(const A2rtPrecision& precision);

  QBoxReference reference;
  std::uint32_t dropped_bits = 0;  // FP32 mantissa bits the direction format lacks
  int columns = 0;
  std::uint32_t low_mask = 0;                       // magnitude bits that select the table's column
  std::vector<std::int8_t> near_bytes, far_bytes;   // columns 1..4: 16 per significand
  std::vector<std::int32_t> near_words, far_words;  // columns 5..8: 2^k per significand
};

// Kernel for this precision and processor, or nullptr if only the scalar one fits.
QBoxTester::Kernel vector_kernel(const A2rtPrecision& precision);
std::uint32_t scalar_kernel(const QBoxTester::Tables& tables, const GroupRay& ray,
                            const std::byte* block, float t_left, float* t_near, bool wide);

}  // namespace a2rt::arith
