// One ray, one group, one child box: what every design of arith/ decides, beside the exact answer.
#pragma once

#include <string>

#include "a2rt/arith/precision.h"
#include "a2rt/base/vec.h"

namespace a2rt::arith::hard {

struct Case {
  Box group, child;
  Vec3 origin, direction;
  float tmin = 0;
  float tmax = Box::kInf;
};

enum class Verdict : std::uint8_t {
  kExact,         // as exact arithmetic
  kConservative,  // says hit where exact arithmetic says miss
  kMisses,        // says miss where exact arithmetic says hit
  kRefuses        // cannot encode the group (AQB8 anchors without extent)
};
std::string name_of(Verdict verdict);

struct Verdicts {
  bool truth = false;  // the exact ray meets the exact child
  Verdict baseline{}, wide{}, guard{}, literal{}, nearest{}, aqb8{}, aqb8_rtl{}, pow2{};
  bool wide_escaped = false, guard_escaped = false;
  float t_shift = 0;  // of the conservative designs
  std::string describe() const;
  // True if none of the designs that promise it misses.
  bool kept() const;
  // True if truth is a miss and every conservative design sees it.
  bool separated() const;
};
Verdicts judge(const Case& c);

}  // namespace a2rt::arith::hard
