#include "a2rt/arith/pow2_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "a2rt/arith/directed.h"
#include "a2rt/base/error.h"
#include "box_check.h"

namespace a2rt::arith {
namespace {

constexpr int kLeastExponent = -126;
constexpr int kSteps = 255;
constexpr float kLargest = std::numeric_limits<float>::max();

// Smallest e with 255 * 2^e >= hi - lo.
std::int8_t exponent_for(float lo, float hi) {
  const ExactSum extent = two_sum(hi, -static_cast<double>(lo));
  if (extent.sum <= 0) {
    return kLeastExponent;
  }
  // ilogb gives 2^e <= extent, so the answer is within ilogb - 8 .. ilogb - 7.
  int e = std::max(std::ilogb(extent.sum) - 8, kLeastExponent);
  const auto covers = [&](int candidate) {
    const double most = std::ldexp(static_cast<double>(kSteps), candidate);
    return most > extent.sum || (most == extent.sum && extent.error <= 0);
  };
  while (!covers(e)) {
    ++e;
  }
  if (mutant(Mutant::kPow2ExponentOneShort)) {
    --e;
  }
  return static_cast<std::int8_t>(std::max(e, kLeastExponent));
}

// floor((x - lo) / 2^e), exact: scaling by a power of two does not round, and where x - lo has a
// residual below FP64, its sign decides at integers.
double floor_steps(float x, float lo, int exponent) {
  const ExactSum d = two_sum(x, -static_cast<double>(lo));
  const double scaled = std::ldexp(d.sum, -exponent);
  const double below = std::floor(scaled);
  return below == scaled && d.error < 0 ? below - 1 : below;
}

std::uint8_t level(double value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0.0, static_cast<double>(kSteps)));
}

}  // namespace

Pow2Frame make_pow2_frame(const Box& box, const std::string& what) {
  require_finite_box(box, what);
  Pow2Frame frame{box.lo, {}};
  for (std::size_t a = 0; a < 3; ++a) {
    frame.exponent[a] = exponent_for(box.lo[a], box.hi[a]);
  }
  return frame;
}

Pow2Box quantize_pow2(const Box& box, const Pow2Frame& frame, const std::string& what) {
  require_finite_box(box, what);
  Pow2Box q;
  for (std::size_t a = 0; a < 3; ++a) {
    const int e = frame.exponent[a];
    double lo = floor_steps(box.lo[a], frame.lo[a], e);
    const double hi = -floor_steps(-box.hi[a], -frame.lo[a], e);
    if (mutant(Mutant::kPow2LoRoundsUp)) {
      lo = -floor_steps(-box.lo[a], -frame.lo[a], e);
    }
    if ((lo < 0 || hi > kSteps) && !mutant(Mutant::kPow2ExponentOneShort)) {
      throw UserError(what + ": box leaves its parent's grid on axis " + std::to_string(a) + " (" +
                      std::to_string(lo) + " to " + std::to_string(hi) +
                      " of 255 steps); rebuild or refit the tree");
    }
    q.lo[a] = level(lo);
    q.hi[a] = level(hi);
  }
  return q;
}

Box dequantize_pow2(const Pow2Box& box, const Pow2Frame& frame) {
  Box out;
  for (std::size_t a = 0; a < 3; ++a) {
    const int e = frame.exponent[a];
    const ExactSum lo = two_sum(frame.lo[a], std::ldexp(static_cast<double>(box.lo[a]), e));
    const ExactSum hi = two_sum(frame.lo[a], std::ldexp(static_cast<double>(box.hi[a]), e));
    out.lo[a] = std::clamp(round_down(lo.sum, lo.error), -kLargest, kLargest);
    out.hi[a] = std::clamp(round_up(hi.sum, hi.error), -kLargest, kLargest);
  }
  return out;
}

}  // namespace a2rt::arith
