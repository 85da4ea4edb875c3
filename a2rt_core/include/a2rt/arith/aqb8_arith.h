// AQB8's arithmetic as its public artifact does it, corner cases included (ISCA 2025; our
// description: spec aqb8 sections 1.2, 1.3, 3, 4, 6). It can miss hits; nothing here repairs that.
//
// FP32 operations are rounded to nearest, in the order written. Conversions to int32 saturate.
// Corners the artifact leaves undefined are defined here as its x86 builds without asserts behave:
//   NaN converts to INT32_MIN; ceil of exactly 2^31 converts to INT32_MIN; a far exponent of 32
//   (near = 0xFFF) shifts by 0 with significand 128 (the RTL's 12-bit wrap).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "a2rt/base/vec.h"

namespace a2rt::arith {

// How FP32 becomes int32 at a cluster entry: the software model floors and ceils, the RTL rounds to
// nearest even.
enum class Aqb8Rounding : std::uint8_t { kFloorCeil, kNearestEven };

// Precision knobs; the defaults are the publication's, to the bit.
struct Aqb8Precision {
  int box_bits = 8;    // 4..8 bits per stored plane: sx = max extent / (2^bits - 1)
  int slope_bits = 8;  // 2..8 significand bits of the 5e8m slopes, hidden bit included

  constexpr int levels() const { return (1 << box_bits) - 1; }
  friend constexpr bool operator==(const Aqb8Precision&, const Aqb8Precision&) = default;
};

// Anchor (cluster) constants: box and 128 / sx with sx = max extent / levels.
struct Aqb8Anchor {
  Box box;
  float inv_sx_inv_sw = 0;  // FP32 128 / sx
  float sx = 0;
  int levels = 255;
};
// Throws UserError naming `what` for inverted, empty or non-finite boxes and for anchors without
// extent (the artifact aborts there), and where sx or 128/sx is not finite and positive.
Aqb8Anchor make_aqb8_anchor(const Box& box, const std::string& what = "anchor",
                            const Aqb8Precision& precision = {});
// True if make_aqb8_anchor would accept the box.
bool aqb8_can_anchor(const Box& box, const Aqb8Precision& precision = {});

struct Aqb8Box {
  std::array<std::uint8_t, 3> lo{}, hi{};
  friend constexpr bool operator==(const Aqb8Box&, const Aqb8Box&) = default;
};
// Throws UserError naming `what` where the artifact asserts (a plane outside 0..levels + 1).
Aqb8Box quantize_aqb8(const Box& box, const Aqb8Anchor& anchor, const std::string& what = "node");
// Half area of the dequantized box (only the clustering cost uses it), FP32.
float aqb8_half_area(const Aqb8Box& box, const Aqb8Anchor& anchor);
Box dequantize_aqb8(const Aqb8Box& box, const Aqb8Anchor& anchor);

// Per-ray constants (INIT): w = 1/d, b = (-o) w, and w in the two 5e8m copies.
struct Aqb8Ray {
  float w[3] = {}, b[3] = {};
  float tmin = 0;
  std::uint8_t negative = 0;                // sign bit of w
  std::uint16_t low[3] = {}, high[3] = {};  // 5-bit shift << 7 | 7-bit significand
};
// Fewer slope bits: the near copy is cut, the far copy is the next larger slope of that width.
Aqb8Ray make_aqb8_ray(const Vec3& origin, const Vec3& direction, float tmin,
                      const Aqb8Precision& precision = {});

// Anchor test (CLSTR a): FP32, unpadded; entry starts at tmin.
struct Aqb8Entry {
  bool hit = false;
  float y_ref = 0;  // entry
};
Aqb8Entry aqb8_anchor_test(const Aqb8Ray& ray, const Aqb8Anchor& anchor, float tmax);

// Local ray (CLSTR c, d): integers in units of sx/128.
struct Aqb8Local {
  std::int32_t low[3] = {}, high[3] = {};  // qb
  std::int32_t qy_max = 0;
  float y_ref = 0;
};
Aqb8Local aqb8_enter(const Aqb8Ray& ray, const Aqb8Anchor& anchor, float y_ref, float tmax,
                     Aqb8Rounding rounding);
// UPDT: qy_max after a closer hit.
std::int32_t aqb8_qy_max(const Aqb8Anchor& anchor, float y_ref, float tmax, Aqb8Rounding rounding);

struct Aqb8Hit {
  bool hit = false;
  std::int32_t entry = 0;  // clamped at 0; the sort key
};
// QBOX: 32-bit wrapping integers.
Aqb8Hit aqb8_test(const Aqb8Ray& ray, const Aqb8Local& local, const Aqb8Box& box);

// Eight boxes, plane by plane, for one call: bit i of the result and entry[i] are what aqb8_test
// says of box i.
struct Aqb8Block {
  static constexpr std::size_t kWidth = 8;
  void put(std::size_t slot, const Aqb8Box& box) {
    for (std::size_t a = 0; a < 3; ++a) {
      planes[0][a][slot] = box.lo[a];
      planes[1][a][slot] = box.hi[a];
    }
  }
  Aqb8Box get(std::size_t slot) const {
    const auto& [lo, hi] = planes;
    return {{lo[0][slot], lo[1][slot], lo[2][slot]}, {hi[0][slot], hi[1][slot], hi[2][slot]}};
  }
  std::uint8_t planes[2][3][kWidth] = {};  // low, high
};
std::uint32_t aqb8_test_block(const Aqb8Ray& ray, const Aqb8Local& local, const Aqb8Block& boxes,
                              std::int32_t entry[Aqb8Block::kWidth]);
// The same, box by box.
std::uint32_t aqb8_test_block_scalar(const Aqb8Ray& ray, const Aqb8Local& local,
                                     const Aqb8Block& boxes, std::int32_t entry[Aqb8Block::kWidth]);

// Saturating conversions, exposed for the tests.
std::int32_t aqb8_floor(float x);
std::int32_t aqb8_ceil(float x);
std::int32_t aqb8_nearest(float x);

}  // namespace a2rt::arith
