// The local coordinate frame of a group: low corner and scale S per axis (paper section III.A and
// III.D: S = SD = 255/l).
//
// Scale rule. N = precision.steps(), l = hi - lo (exact).
//   l > 0 : S = the FP32 number below or at N/l, at most FLT_MAX, so that l*S <= N holds exactly
//           and hence ceil(l*S) <= N. Extents beyond FLT_MAX (lo < 0 < hi) are handled in FP64;
//           S is never denormal because l <= 2^129. For denormal extents S is capped at FLT_MAX:
//           boxes then use few levels, which is coarse but conservative.
//   l = 0 : every S quantizes exactly; S = the largest scale of the other axes (wide design: 16
//           times that), 1 if all are zero.
//   single: the smallest of the axes' scales on all axes.
//   literal: S = fl(N / fl(l)), unguarded, FLT_MAX where that is not finite.
#pragma once

#include <string>

#include "a2rt/arith/precision.h"
#include "a2rt/base/vec.h"

namespace a2rt::arith {

struct GroupFrame {
  Vec3 lo;     // world position of local 0
  Vec3 scale;  // levels per world unit, per axis; finite, positive, normal
  friend constexpr bool operator==(const GroupFrame&, const GroupFrame&) = default;
};

// Throws UserError naming `what` (the node) if the box is inverted, empty or not finite.
GroupFrame make_group_frame(const Box& box, const A2rtPrecision& precision,
                            const std::string& what = "group node");
// The scale of one axis before sharing; lo <= hi finite; 0 for a zero extent.
float axis_scale(float lo, float hi, int steps);

}  // namespace a2rt::arith
