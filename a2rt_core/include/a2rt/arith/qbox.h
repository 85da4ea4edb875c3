// The quantized ray-box test QBOX (paper section IV.A item 3; a2rt-numerics section 3).
//
// Per axis, s = sign of d:
//   near: A = max(0, s (q_near - O_near)); t_near = A * m_lo on the tmin path
//   far : A = s (q_far - O_far); A < 0 is a miss; t_far = A * m_hi on the tmax path
// hit iff max(0, t_near...) <= min(t_left, t_far...).
//
// Conservative: q_near <= exact plane (seen along d) and O_near >= c, so A <= exact distance in
// levels; m_lo <= 1/|g| and the tmin path never rounds up, so t_near <= exact, or 0 where the exact
// value is <= 0 (t' >= 0 holds for every hit because t_s is not later than the group's entry). Far
// mirrors it; A < 0 means the exact far plane lies behind the shifted origin. t_left was rounded
// up. So an exact common t' makes every t_near <= t' <= every t_far.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "a2rt/arith/multiplier.h"
#include "a2rt/arith/quantized_box.h"
#include "a2rt/arith/ray_quantizer.h"

namespace a2rt::arith {

struct QBoxHit {
  bool hit = false;
  float t_near = 0;  // counted from the group's t_shift, in the direction format; orders children
};

// Scalar reference; the definition of the test.
class QBoxReference {
 public:
  explicit QBoxReference(const A2rtPrecision& precision) : multiplier_(precision) {}
  // t_left from RayQuantizer::remaining.
  QBoxHit test(const GroupRay& ray, const QuantizedBox& box, float t_left) const;

 private:
  IntFloatMultiplier multiplier_;
};

// Up to eight boxes of one group per call: the hot loop. Bit-equal to QBoxReference. Uses AVX2 when
// the processor has it and the format has FP32's range and at most 10 significand bits.
//
//   QBoxTester tester(precision);
//   std::vector<std::byte> block(tester.block_bytes());   // 16-byte aligned
//   tester.put(block.data(), slot, box);
//   mask = tester.test(group_ray, block.data(), t_left, t_near);
class QBoxTester {
 public:
  static constexpr std::size_t kWidth = 8;
  // Called with the tester's tables; what the kernels implement.
  struct Tables;
  using Kernel = std::uint32_t (*)(const Tables&, const GroupRay&, const std::byte*, float, float*);

  // `allow_simd` = false forces the scalar kernel.
  explicit QBoxTester(const A2rtPrecision& precision, bool allow_simd = true);

  // Bytes of a block of kWidth boxes: 48 (box_bits <= 8) or 96. Fresh blocks must be cleared.
  std::size_t block_bytes() const { return wide_ ? 96 : 48; }
  // Makes all slots empty; an empty slot is never hit unless masked slots are ignored by the caller
  // (bits of slots that were never put are unspecified for rays parallel to an axis).
  void clear(std::byte* block) const;
  void put(std::byte* block, std::size_t slot, const QuantizedBox& box) const;
  QuantizedBox get(const std::byte* block, std::size_t slot) const;

  // Bit i: slot i is hit; t_near[i] as QBoxHit::t_near (kWidth entries, unspecified without a hit).
  std::uint32_t test(const GroupRay& ray, const std::byte* block, float t_left,
                     float t_near[kWidth]) const {
    return kernel_(*tables_, ray, block, t_left, t_near);
  }
  bool uses_simd() const { return simd_; }

 private:
  bool wide_, simd_ = false;
  std::shared_ptr<const Tables> tables_;
  Kernel kernel_;
};

}  // namespace a2rt::arith
