// Ray, group and child box from raw bits against the exact oracle: no conservative design may miss.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "a2rt/arith/aqb8_arith.h"
#include "a2rt/arith/oracle.h"
#include "a2rt/arith/pow2_frame.h"
#include "a2rt/arith/qbox.h"
#include "a2rt/arith/slab.h"

namespace a2rt::arith {
namespace {

// Input: selector byte, then FP32 bit patterns; missing bytes read as zero.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  std::uint8_t byte() { return at_ < size_ ? data_[at_++] : std::uint8_t{0}; }
  float number() {
    std::array<std::uint8_t, 4> raw{};
    for (std::uint8_t& b : raw) {
      b = byte();
    }
    float x = 0;
    std::memcpy(&x, raw.data(), sizeof x);
    return x;
  }
  float finite() {
    const float x = number();
    return std::isfinite(x) ? x : 0;
  }
  Vec3 point() {
    Vec3 p;
    for (std::size_t a = 0; a < 3; ++a) {
      p[a] = finite();
    }
    return p;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

void demand(bool holds, const char* claim) {
  if (!holds) {
    std::fprintf(stderr, "broken: %s\n", claim);
    std::abort();
  }
}

Box box_around(const Vec3& p, const Vec3& q) {
  Box box;
  box.include(p);
  box.include(q);
  return box;
}

A2rtPrecision pick_precision(std::uint8_t selector) {
  constexpr FloatFormat kFormats[] = {kBf16, kFp16, kFp32, reduced_significand(5)};
  A2rtPrecision p;
  p.origin = (selector & 1U) != 0 ? OriginDesign::kGuard : OriginDesign::kWide;
  p.box_bits = 4 + (selector >> 1 & 7);
  p.direction = kFormats[selector >> 4 & 3];
  p.multiplier_columns = (selector >> 6 & 3) * 2;
  return p;
}

struct Input {
  Box group, child;
  Vec3 origin, direction;
  float tmin = 0, tmax = 0;
};

Input read_input(Bytes& bytes) {
  Input in;
  in.group = box_around(bytes.point(), bytes.point());
  in.child = box_around(bytes.point(), bytes.point());
  for (std::size_t a = 0; a < 3; ++a) {
    in.child.lo[a] = std::clamp(in.child.lo[a], in.group.lo[a], in.group.hi[a]);
    in.child.hi[a] = std::clamp(in.child.hi[a], in.group.lo[a], in.group.hi[a]);
  }
  in.direction = bytes.point();
  in.origin = bytes.point();
  in.tmin = std::fabs(bytes.finite());
  in.tmax = bytes.number();
  return in;
}

void check_a2rt(const Input& in, const A2rtPrecision& precision, const SlabRay& slab, bool truth) {
  const SlabHit entry = slab_test(slab, in.group, in.tmax);
  demand(!truth || entry.hit, "the slab test keeps the group of a hit child");
  if (!entry.hit) {
    return;
  }
  const GroupFrame frame = make_group_frame(in.group, precision);
  const QuantizedBox stored = quantize_box(in.child, in.group, frame, precision);
  const RayQuantizer quantizer(precision);
  GroupRay local;
  if (quantizer.enter(make_quantizer_ray(in.origin, in.direction), frame, entry.t_entry, local) ==
      GroupEntry::kEscaped) {
    const Box back = dequantize_box(stored, frame, precision);
    demand(!truth || slab_test(slab, back, in.tmax).hit, "an escaped pair keeps the hit");
    return;
  }
  const float left = quantizer.remaining(in.tmax, entry.t_entry);
  const QBoxHit hit = QBoxReference(precision).test(local, stored, left);
  demand(!truth || hit.hit, "the quantized test keeps the hit");
  demand(!std::isnan(hit.t_near), "no NaN leaves the tester");
  const QBoxTester tester(precision);
  alignas(16) std::byte block[96];
  tester.clear(block);
  tester.put(block, 3, stored);
  float near[QBoxTester::kWidth];
  const bool fast = (tester.test(local, block, left, near) >> 3 & 1U) != 0;
  demand(fast == hit.hit, "the kernel agrees with the reference");
  demand(!fast || near[3] == hit.t_near, "the kernel's entry equals the reference's");
}

// AQB8 may miss, but its answers must be defined.
void check_aqb8(const Input& in) {
  if (!aqb8_can_anchor(in.group)) {
    return;
  }
  const Aqb8Anchor anchor = make_aqb8_anchor(in.group);
  const Aqb8Ray ray = make_aqb8_ray(in.origin, in.direction, in.tmin);
  const Aqb8Entry entry = aqb8_anchor_test(ray, anchor, in.tmax);
  const Aqb8Box box = quantize_aqb8(in.child, anchor);
  for (const Aqb8Rounding rounding : {Aqb8Rounding::kFloorCeil, Aqb8Rounding::kNearestEven}) {
    const Aqb8Local local = aqb8_enter(ray, anchor, entry.y_ref, in.tmax, rounding);
    demand(aqb8_test(ray, local, box).entry >= 0, "AQB8's entry is clamped at 0");
  }
}

void check_one(Bytes bytes) {
  const A2rtPrecision precision = pick_precision(bytes.byte());
  const Input in = read_input(bytes);
  if (!ray_is_active(in.origin, in.direction, in.tmin, in.tmax)) {
    return;
  }
  const OracleRay oracle(in.origin, in.direction, in.tmin);
  const bool truth = ray_meets_box(oracle, in.child, in.tmax);
  demand(truth == ray_meets_box_rational(oracle, in.child, in.tmax),
         "the oracle's filters agree with rationals");
  const SlabRay slab = make_slab_ray(in.origin, in.direction, in.tmin);
  const SlabHit hit = slab_test(slab, in.child, in.tmax);
  demand(!truth || hit.hit, "the slab test keeps the hit");
  demand(!truth || shift_is_early(oracle, in.child, hit.t_entry), "the entry is not late");
  check_a2rt(in, precision, slab, truth);
  const Pow2Frame frame = make_pow2_frame(in.group);
  const Box grid = dequantize_pow2(quantize_pow2(in.child, frame), frame);
  demand(!truth || slab_test(slab, grid, in.tmax).hit, "the power-of-two grid keeps the hit");
  check_aqb8(in);
}

}  // namespace
}  // namespace a2rt::arith

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  a2rt::arith::check_one({data, size});
  return 0;
}
