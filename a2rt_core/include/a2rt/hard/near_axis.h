// AQB8's loss at directions almost parallel to an axis, as the study of its artifact measured it.
#pragma once

#include <cstdint>
#include <vector>

#include "a2rt/arith/aqb8_arith.h"

namespace a2rt::hard {

struct LossRate {
  std::uint64_t hits = 0, missed = 0;
  std::uint64_t missed_anchors = 0;  // of hits; not counted in missed: another mechanism
  double percent() const { return 100.0 * static_cast<double>(missed) / static_cast<double>(hits); }
};

// `rays` rays aimed into a random child box of a random anchor, with |d_y| in 2^exponent ..
// 2^(exponent + 1); seeded by the exponent.
LossRate aqb8_near_axis_loss(int exponent, arith::Aqb8Rounding rounding, std::uint32_t rays);

// What the study of the artifact says is lost (its section 6, item 1).
struct NearAxisRow {
  int exponent;    // |d| in 2^exponent .. 2^(exponent + 1)
  double percent;  // of the rays aimed into a box
};
const std::vector<NearAxisRow>& aqb8_near_axis_table();

}  // namespace a2rt::hard
