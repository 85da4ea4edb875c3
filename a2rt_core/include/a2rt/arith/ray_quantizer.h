// The ray quantization unit: moves a ray's origin to a group's entry and quantizes it (paper
// sections III.C and IV.A item 2; a2rt-numerics sections 1-3).
//
// For a group frame (lo, S) and a shift t_s <= exact entry (slab.h), the exact local ray is
// c + t' g with c = (o + t_s d - lo) S, g = d S, t' = t - t_s: real t counted from the shift.
// enter() produces integers O_min <= c <= O_max and rates m_lo <= 1/|g| <= m_hi in the direction
// format, or says that the pair escapes. The lemmas stand beside the code in ray_quantizer.cpp.
#pragma once

#include <cstdint>

#include "a2rt/arith/group_frame.h"
#include "a2rt/arith/precision.h"
#include "a2rt/base/vec.h"

namespace a2rt::arith {

// Per-ray set-up; make with make_quantizer_ray. d = -0 counts as +0.
struct alignas(16) QuantizerRay {
  float origin[4] = {};
  float dir[4] = {};
  std::uint8_t negative = 0;  // bit a: d[a] < 0
  std::uint8_t zero = 0;      // bit a: d[a] == 0
};
QuantizerRay make_quantizer_ray(const Vec3& origin, const Vec3& direction);

// A ray as the quantized tester sees it inside one group (the context a traversal keeps). Index 3
// of the arrays is padding.
struct alignas(32) GroupRay {
  // Origin bound used with the near and the far plane, as integers carried in FP32; offset as in
  // the stored boxes.
  float near_origin[4] = {}, far_origin[4] = {};
  // Rates with the sign of d: m_lo for near, m_hi for far. inf marks a parallel axis.
  float near_rate[4] = {}, far_rate[4] = {};
  // For the multiplier's correction tables (filled if multiplier_columns > 0): the unit in the last
  // place of the rate (0 for infinite and zero rates) and its significand without the hidden bit.
  float near_unit[4] = {}, far_unit[4] = {};
  std::uint32_t near_row[4] = {}, far_row[4] = {};
  // The same for the paired kernel, near in the low half and far in the high one: origins as 16-bit
  // integers; significands with the hidden bit, and in the upper 16 bits the sign of their
  // correction; units, the far one negated. Valid if `paired`.
  std::uint32_t origin_pair[4] = {};
  std::uint32_t factor_pair[4][2] = {};
  float unit_pair[4][2] = {};
  float t_shift = 0;
  std::uint8_t negative = 0;  // bit a: the near plane is hi
  bool paired = false;
};

enum class GroupEntry : std::uint8_t {
  kQuantized,
  kEscaped  // origin outside the representable range: test the children's dequantized boxes in FP32
};

class RayQuantizer {
 public:
  explicit RayQuantizer(const A2rtPrecision& precision);

  // t_shift: SlabHit::t_entry of the group's box. `out` is valid only if kQuantized is returned.
  GroupEntry enter(const QuantizerRay& ray, const GroupFrame& frame, float t_shift,
                   GroupRay& out) const;
  // The same without vector instructions; bit-equal.
  GroupEntry enter_scalar(const QuantizerRay& ray, const GroupFrame& frame, float t_shift,
                          GroupRay& out) const;
  // Remaining interval for the tester: t_closest - t_shift rounded up to the direction format,
  // at most the format's largest finite number. t_closest >= t_shift; inf allowed.
  float remaining(float t_closest, float t_shift) const;

  const A2rtPrecision& precision() const { return precision_; }

 private:
  struct Rates {
    float near = 0, far = 0;
  };
  Rates rates(float dir, float scale) const;
  Rates substitute_rates(float dir, float rate) const;
  bool conservative_origin(const QuantizerRay& ray, const GroupFrame& frame, float t_shift,
                           float lowest[3], float highest[3]) const;
  bool plain_origin(const QuantizerRay& ray, const GroupFrame& frame, float t_shift,
                    float lowest[3], float highest[3]) const;
  void set_tables(GroupRay& out) const;
  float round_near(float value) const;
  float round_far(float value) const;

  A2rtPrecision precision_;
  std::uint32_t dropped_bits_ = 0;  // FP32 mantissa bits the direction format lacks
  float largest_, min_origin_, max_origin_, offset_;
};

}  // namespace a2rt::arith
