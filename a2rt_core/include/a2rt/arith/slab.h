// The accurate unit's ray-box test: FP32 slabs, never missing a box that the exact ray meets.
//
// Source: Kay and Kajiya 1986 (slabs), Ize 2013 (padding against rounding). Two paths with one
// contract, chosen per ray:
//   regular   - plain FP32 round-to-nearest operations, padded once at the end (the hardware's);
//   irregular - FP64 intervals, for denormal or huge directions, negative tmin and coordinates that
//               may overflow FP32 differences.
//
// Contract, for finite o, d, tmin, any tmax (inf allowed) and every box with lo <= hi, finite:
//   if some t in [tmin, tmax] has o + t d in the box, the test says hit, and t_entry is at least
//   tmin and not later than the first such t (real-number arithmetic).
//
// Proof for the regular path. u = 2^-24. Per plane x the computed t' = fl(fl(x-o) * fl(1/d)).
//   The difference of two FP32 numbers is rounded with relative error <= u, also when denormal
//   (then it is exact). 1/d is normal because 2^-126 <= |d| <= 2^126, relative error <= u. The
//   product has relative error <= u, plus 2^-150 if it underflows. Signs are exact.
//   near: t >= 0 exact. t' <= t (1+u)^3 + 2^-149. The padded value fl(fl(t' (1-4u)) - 2^-120)
//     <= t: one more rounding (1+u), and (1-4u)(1+u)^4 <= 1; the absolute terms are far below
//     2^-120. For t < 0, t' <= 0, and the clamp with tmin >= 0 makes the value irrelevant.
//   far: t >= 0 exact. fl(fl(t' (1+6u)) + 2^-120) >= t since (1+6u)(1-u)^4 >= 1. For t < 0 the box
//     is behind tmin >= 0 and any answer is conservative.
//   Overflow: x - o = +-inf needs |x - o| > FLT_MAX. On far planes it widens or has the sign of a
//     true miss. On a near plane t' = inf is replaced by FLT_MAX before padding, which is <= t
//     (1+u)^3 because |d| <= 1 (regular rays whose differences can overflow are required to have
//     |d| <= 1) or because the product itself overflowed.
//   d = 0: 1/d = inf; a plane strictly on the allowed side gives the harmless infinity, on the
//     forbidden side the infinity that misses, and a plane through o gives 0 * inf = NaN, which
//     max/min drop (they return their second operand): the closed slab contains o, as required.
//   Padding after max/min equals padding before, because both are monotone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "a2rt/base/vec.h"

namespace a2rt::arith {

inline constexpr float kLargestFloat = std::numeric_limits<float>::max();

// A ray prepared for slab tests; make with make_slab_ray.
struct SlabRay {
  float origin[3] = {};
  float rcp[3] = {};  // fl(1/d), +inf for d = +-0
  float dir[3] = {};
  float tmin = 0;
  std::uint8_t negative = 0;  // bit a: d[a] < 0
  bool regular = false;       // may use the FP32 path
};

// True if the ray can hit anything: finite origin and direction, finite tmin <= tmax, tmax not NaN.
// Inactive rays must not be handed to any test (Vulkan leaves them undefined; here they miss).
bool ray_is_active(const Vec3& origin, const Vec3& direction, float tmin, float tmax);

// `largest_coordinate` bounds |x| over all planes that will be tested; the better it is known the
// more rays with |d| > 1 stay on the fast path. The ray must be active.
SlabRay make_slab_ray(const Vec3& origin, const Vec3& direction, float tmin,
                      float largest_coordinate = kLargestFloat);

struct SlabHit {
  bool hit = false;
  float t_entry = 0;  // lower bound of the entry, >= tmin; meaningless without a hit
};
SlabHit slab_test(const SlabRay& ray, const Box& box, float tmax);

// The FP64 path for any active ray; its t_entry is the exact entry rounded down, to within 2^-50.
SlabHit slab_test_wide(const SlabRay& ray, const Box& box, float tmax);

// The textbook test without any padding (Kay and Kajiya), FP32: what a naive unit computes. Its
// entry may be late and it may miss hits.
SlabHit slab_test_plain(const SlabRay& ray, const Box& box, float tmax);

// Up to eight boxes, structure of arrays. Unused slots must be empty boxes (Box{}) or masked by the
// caller.
struct alignas(32) BoxBlock {
  static constexpr std::size_t kWidth = 8;
  float lo[3][kWidth];
  float hi[3][kWidth];
  BoxBlock();
  void put(std::size_t slot, const Box& box);
  Box get(std::size_t slot) const;
};

// Bit i: slot i is hit; t_entry[i] as in SlabHit. Bit-equal to slab_test of each box. Uses AVX2 if
// the processor has it.
std::uint32_t slab_test_block(const SlabRay& ray, const BoxBlock& boxes, float tmax,
                              float t_entry[BoxBlock::kWidth]);
// The same without AVX2 (what slab_test_block falls back to).
std::uint32_t slab_test_block_scalar(const SlabRay& ray, const BoxBlock& boxes, float tmax,
                                     float t_entry[BoxBlock::kWidth]);

}  // namespace a2rt::arith
