// The truth the units are judged by: exact (rational) answers about rays and boxes.
//
// ray_meets_box is fast: FP64 intervals decide nearly all cases, exact FP64 pairs most ties, and
// rationals the rest. The stage checks are slow and meant for tests.
#pragma once

#include <cstdint>

#include "a2rt/arith/group_frame.h"
#include "a2rt/arith/precision.h"
#include "a2rt/arith/quantized_box.h"
#include "a2rt/arith/ray_quantizer.h"
#include "a2rt/base/vec.h"

namespace a2rt::arith {

// A ray prepared for many exact tests. Finite origin and direction; tmin finite; tmax may be inf.
struct OracleRay {
  OracleRay(const Vec3& origin, const Vec3& direction, float tmin);
  double origin[3], dir[3], rcp[3];
  double tmin;
};

// Does some real t in [tmin, tmax] have o + t d in the closed box? Exact for all finite inputs.
bool ray_meets_box(const OracleRay& ray, const Box& box, float tmax);
// The same by rationals only (to check the filters).
bool ray_meets_box_rational(const OracleRay& ray, const Box& box, float tmax);

// How often each stage of ray_meets_box decided, for the filters' own tests.
enum class OracleStage : std::uint8_t { kInterval, kPairs, kRational };
bool ray_meets_box(const OracleRay& ray, const Box& box, float tmax, OracleStage& decided_by);

// Stage checks; each is true if the stage's promise holds for these values, exactly.
// (hi - lo) S <= steps on every axis.
bool scale_is_safe(const Box& group, const GroupFrame& frame, const A2rtPrecision& precision);
// The dequantized box contains the box.
bool box_is_contained(const Box& box, const QuantizedBox& stored, const GroupFrame& frame,
                      const A2rtPrecision& precision);
// The FP32 box contains the exact dequantized box.
bool dequantized_is_contained(const QuantizedBox& stored, const Box& fp32, const GroupFrame& frame,
                              const A2rtPrecision& precision);
// t_shift >= tmin and not later than the first t >= tmin at which the ray is in the box (which the
// ray must meet).
bool shift_is_early(const OracleRay& ray, const Box& box, float t_shift);
// O_min <= c <= O_max on every axis, for c = (o + t_shift d - lo) S.
bool origin_is_contained(const QuantizerRay& ray, const GroupFrame& frame, const GroupRay& local,
                         const A2rtPrecision& precision);
// m_lo <= 1/|d S| <= m_hi on every axis (d = 0: both infinite).
bool rates_are_contained(const QuantizerRay& ray, const GroupFrame& frame, const GroupRay& local);
// remaining >= t_closest - t_shift, or remaining is `largest`.
bool remaining_is_late(float remaining, float t_closest, float t_shift, float largest);

}  // namespace a2rt::arith
