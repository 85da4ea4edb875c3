#include "properties.h"

#include <boost/multiprecision/gmp.hpp>
#include <cmath>
#include <limits>

#include "a2rt/arith/directed.h"
#include "a2rt/arith/multiplier.h"
#include "a2rt/arith/oracle.h"
#include "a2rt/arith/pow2_frame.h"
#include "a2rt/arith/qbox.h"
#include "a2rt/arith/slab.h"
#include "a2rt/hard/strata.h"

namespace a2rt::arith::testing {
namespace {

using namespace a2rt::hard;

using Rational = boost::multiprecision::mpq_rational;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kLargest = std::numeric_limits<float>::max();

class Tally {
 public:
  explicit Tally(bool stop_early) : stop_early_(stop_early) {}
  template <class Describe>
  void check(bool holds, Describe describe) {
    ++result_.checks;
    if (!holds && ++result_.failures == 1) {
      result_.first = describe();
    }
  }
  bool done() const { return stop_early_ && result_.failures > 0; }
  const PropertyResult& result() const { return result_; }

 private:
  bool stop_early_;
  PropertyResult result_;
};

// Calls body(random, stratum, group, ray) for every case.
template <class Body>
PropertyResult over_cases(std::uint64_t seed, std::uint64_t cases, bool stop_early, Body body) {
  Tally tally(stop_early);
  Random random(seed);
  for (std::uint64_t i = 0; i < cases && !tally.done(); ++i) {
    // A stride coprime to the number of strata mixes them within short runs.
    const Stratum s = stratum(static_cast<std::uint32_t>(i * 253 % kStrata));
    const TestGroup group = make_group(random, s);
    const TestRay ray = make_ray(random, s, group);
    if (ray_is_active(ray.origin, ray.direction, ray.tmin, ray.tmax)) {
      body(tally, random, s, group, ray);
    }
  }
  return tally.result();
}

const A2rtPrecision& some_precision(Random& random) {
  const auto& all = conservative_precisions();
  return all[random.below(static_cast<std::uint32_t>(all.size()))];
}

// value <= exact < next float, mirrored for up.
bool is_floor(float value, const Rational& exact) {
  if (std::isinf(value)) {
    return value < 0 && exact < Rational(-kLargest);
  }
  if (Rational(value) > exact) {
    return false;
  }
  return value == kLargest || Rational(next_up(value)) > exact;
}
bool is_ceiling(float value, const Rational& exact) { return is_floor(-value, -exact); }

PropertyResult check_directed(std::uint64_t seed, std::uint64_t cases, bool stop_early) {
  Tally tally(stop_early);
  Random random(seed);
  for (std::uint64_t i = 0; i < cases && !tally.done(); ++i) {
    const float a = random.chance(4) ? random.magnitude(-30, 30, true) : random.any_finite();
    const float b = random.chance(3) ? random.magnitude(-30, 30, true) : random.any_finite();
    const Rational x(a);
    const Rational y(b);
    const auto say = [&] { return std::to_string(a) + ", " + std::to_string(b); };
    tally.check(is_floor(add_down(a, b), x + y) && is_ceiling(add_up(a, b), x + y), say);
    tally.check(is_floor(sub_down(a, b), x - y) && is_ceiling(sub_up(a, b), x - y), say);
    tally.check(is_floor(mul_down(a, b), x * y) && is_ceiling(mul_up(a, b), x * y), say);
    if (b != 0) {
      tally.check(is_floor(div_down(a, b), x / y) && is_ceiling(div_up(a, b), x / y), say);
      tally.check(is_floor(rcp_down(b), 1 / y) && is_ceiling(rcp_up(b), 1 / y), say);
    }
  }
  return tally.result();
}

// Towards zero and away from zero bracket the value by neighbours of the format.
PropertyResult check_formats(std::uint64_t seed, std::uint64_t cases, bool stop_early) {
  Tally tally(stop_early);
  Random random(seed);
  const FloatFormat formats[] = {kBf16, kFp16, kFp32, reduced_significand(5),
                                 reduced_significand(10)};
  for (std::uint64_t i = 0; i < cases && !tally.done(); ++i) {
    const FloatFormat f = formats[random.below(5)];
    double x = random.chance(2) ? random.any_finite() : random.magnitude(-30, 20, true);
    if (random.chance(4)) {
      x = round_to(x, f, Rounding::kTowardZero);  // representable values must be kept
    }
    const float in = round_to(x, f, Rounding::kTowardZero);
    const float out = round_to(x, f, Rounding::kAwayFromZero);
    const float near = round_to(x, f, Rounding::kNearestEven);
    const auto say = [&] { return std::to_string(x) + " to " + a2rt::arith::name_of(f); };
    const double size = std::fabs(x);
    tally.check(std::fabs(in) <= size && !std::isinf(in) && !std::isnan(in), say);
    tally.check(std::fabs(out) >= size && !std::isnan(out), say);
    // in and out are the same number or neighbours: their encodings differ by at most one.
    tally.check(encode(std::fabs(out), f) - encode(std::fabs(in), f) <= (in == x ? 0U : 1U), say);
    tally.check(decode(encode(in, f), f) == in, say);
    const double below = size - std::fabs(static_cast<double>(in));
    const double above = std::fabs(static_cast<double>(out)) - size;
    tally.check(std::isinf(out) || near == (below < above ? in : above < below ? out : near), say);
  }
  return tally.result();
}

PropertyResult check_products(std::uint64_t seed, std::uint64_t cases, bool stop_early) {
  Tally tally(stop_early);
  Random random(seed);
  for (std::uint64_t i = 0; i < cases && !tally.done(); ++i) {
    const A2rtPrecision& precision = some_precision(random);
    const FloatFormat f = precision.direction;
    const IntFloatMultiplier multiplier(precision);
    const std::uint32_t a = random.below(1U << precision.magnitude_bits());
    const bool narrow = !f.fp32_range();
    const double m = random.magnitude(narrow ? -24 : -140, narrow ? 15 : 120, false);
    const float rate = round_to(m, f, Rounding::kTowardZero);
    const double exact = static_cast<double>(a) * rate;
    const float low = multiplier.near(a, rate);
    const float high = multiplier.far(a, rate);
    const auto say = [&] { return std::to_string(a) + " * " + std::to_string(m); };
    tally.check(low <= exact && high >= exact && !std::isinf(low), say);
    // Without approximate columns the product is within one unit of the format.
    if (precision.multiplier_columns == 0 && exact > 0) {
      tally.check(low == round_to(exact, f, Rounding::kTowardZero) &&
                      high == round_to(exact, f, Rounding::kAwayFromZero),
                  say);
    }
    tally.check(multiplier.near(a, kInfinity) == (a == 0 ? 0 : kInfinity) &&
                    multiplier.far(a, kInfinity) == kInfinity,
                say);
  }
  return tally.result();
}

PropertyResult check_columns(std::uint64_t seed, std::uint64_t cases, bool stop_early) {
  Tally tally(stop_early);
  Random random(seed);
  for (std::uint64_t i = 0; i < cases && !tally.done(); ++i) {
    const int k = static_cast<int>(random.below(9));
    const LowColumns mode = random.chance(2) ? LowColumns::kCompress : LowColumns::kDrop;
    const int n = 8 + static_cast<int>(random.below(5));
    const ApproxMultiplier multiplier(n, 8, k, mode);
    const std::uint32_t b = 128 + random.below(128);
    const std::uint32_t a = random.below(1U << n);
    const std::uint64_t exact = static_cast<std::uint64_t>(a) * b;
    const auto say = [&] {
      return std::to_string(a) + " * " + std::to_string(b) + " k " + std::to_string(k);
    };
    tally.check(multiplier.low(a, b) <= exact && multiplier.high(a, b) >= exact, say);
    // Columns from k on are exact: the approximate product differs only as far as the low columns
    // and their compensation reach, and not at all if no low bit is set.
    const std::uint64_t low_bits = (a & ((1U << k) - 1)) == 0 ? 0 : ~std::uint64_t{0};
    tally.check(low_bits != 0 || (multiplier.low(a, b) == exact && multiplier.high(a, b) == exact),
                say);
    const std::uint64_t span = static_cast<std::uint64_t>(k) << k;
    tally.check(exact - multiplier.low(a, b) <= span, say);
    tally.check(multiplier.high(a, b) - exact <= span + (1U << k), say);
  }
  return tally.result();
}

PropertyResult check_frames_and_boxes(std::uint64_t seed, std::uint64_t cases, bool stop_early) {
  return over_cases(
      seed, cases, stop_early,
      [](Tally& tally, Random& random, const Stratum& s, const TestGroup& group, const TestRay&) {
        const A2rtPrecision& precision = some_precision(random);
        const auto say = [&] { return name_of(s) + ": " + describe(group.box); };
        const GroupFrame frame = make_group_frame(group.box, precision);
        tally.check(scale_is_safe(group.box, frame, precision), say);
        if (!scale_is_safe(group.box, frame, precision)) {
          return;
        }
        const Box& child = group.children[random.below(kChildren)];
        const QuantizedBox q = quantize_box(child, group.box, frame, precision);
        tally.check(box_is_contained(child, q, frame, precision),
                    [&] { return say() + ", child " + describe(child); });
        const Box back = dequantize_box(q, frame, precision);
        tally.check(dequantized_is_contained(q, back, frame, precision),
                    [&] { return say() + ", child " + describe(child); });
      });
}

PropertyResult check_slab(std::uint64_t seed, std::uint64_t cases, bool stop_early) {
  return over_cases(
      seed, cases, stop_early,
      [](Tally& tally, Random& random, const Stratum& s, const TestGroup& group,
         const TestRay& ray) {
        const float bound = random.chance(2) ? kLargest : 0x1p30F;
        const bool bounded = bound < kLargest && s.magnitude != MagnitudeKind::kHuge;
        const SlabRay slab =
            make_slab_ray(ray.origin, ray.direction, ray.tmin, bounded ? bound : kLargest);
        const OracleRay oracle(ray.origin, ray.direction, ray.tmin);
        for (const Box& box : group.children) {
          if (!ray_meets_box(oracle, box, ray.tmax)) {
            continue;
          }
          const auto say = [&] { return name_of(s) + ": " + describe(ray) + ", " + describe(box); };
          for (const SlabHit& hit :
               {slab_test(slab, box, ray.tmax), slab_test_wide(slab, box, ray.tmax)}) {
            tally.check(hit.hit, say);
            tally.check(!hit.hit || (std::isfinite(hit.t_entry) && hit.t_entry >= ray.tmin), say);
          }
          // The rational check is slow: one box in four.
          if (random.chance(4)) {
            const SlabHit hit = slab_test(slab, box, ray.tmax);
            tally.check(!hit.hit || (std::isfinite(hit.t_entry) &&
                                     shift_is_early(oracle, box, hit.t_entry)),
                        say);
            const SlabHit wide = slab_test_wide(slab, box, ray.tmax);
            tally.check(!wide.hit || shift_is_early(oracle, box, wide.t_entry), say);
          }
        }
      });
}

// Rays that graze a box's edge: near plane of x and far plane of y are met at times equal to within
// FP32 rounding, so that only the padding keeps the hit. Twenty rays a case: few of them combine
// rounding errors badly enough.
PropertyResult check_slab_edges(std::uint64_t seed, std::uint64_t cases, bool stop_early) {
  Tally tally(stop_early);
  Random random(seed);
  for (std::uint64_t i = 0; i < 20 * cases && !tally.done(); ++i) {
    TestRay ray;
    ray.direction = {(1 + random.unit()) / 2, (1 + random.unit()) / 2, 0};
    ray.origin = {-random.unit(), -random.unit(), 0};
    ray.tmax = kInfinity;
    Box box{{random.unit() + 0.1F, -8, -1}, {9, 0, 1}};
    const double t = (static_cast<double>(box.lo.x) - ray.origin.x) / ray.direction.x;
    box.hi.y = round_up(ray.origin.y + t * ray.direction.y);
    if (ray_meets_box(OracleRay(ray.origin, ray.direction, 0), box, ray.tmax)) {
      const SlabRay slab = make_slab_ray(ray.origin, ray.direction, 0);
      tally.check(slab_test(slab, box, ray.tmax).hit,
                  [&] { return describe(ray) + ", " + describe(box); });
    }
  }
  return tally.result();
}

PropertyResult check_ray_quantizer(std::uint64_t seed, std::uint64_t cases, bool stop_early) {
  return over_cases(
      seed, cases, stop_early,
      [](Tally& tally, Random& random, const Stratum& s, const TestGroup& group,
         const TestRay& ray) {
        const A2rtPrecision& precision = some_precision(random);
        const RayQuantizer quantizer(precision);
        const GroupFrame frame = make_group_frame(group.box, precision);
        const SlabHit entry =
            slab_test(make_slab_ray(ray.origin, ray.direction, ray.tmin), group.box, ray.tmax);
        const float t_shift = entry.hit ? entry.t_entry : ray.tmin;
        const auto say = [&] {
          return name_of(s) + ", " + name_of(precision) + ": " + describe(ray) + ", group " +
                 describe(group.box);
        };
        const QuantizerRay q = make_quantizer_ray(ray.origin, ray.direction);
        GroupRay local;
        if (quantizer.enter(q, frame, t_shift, local) == GroupEntry::kQuantized) {
          tally.check(origin_is_contained(q, frame, local, precision), say);
          tally.check(rates_are_contained(q, frame, local), say);
        }
        if (ray.tmax >= t_shift) {
          tally.check(remaining_is_late(quantizer.remaining(ray.tmax, t_shift), ray.tmax, t_shift,
                                        max_finite(precision.direction)),
                      say);
        }
      });
}

// Half of the cases leave a difference barely above a number of the format, which FP32 rounds to
// that number: t_closest is the FP32 number above (left + t_shift), t_shift of the size of its ulp.
PropertyResult check_remaining(std::uint64_t seed, std::uint64_t cases, bool stop_early) {
  Tally tally(stop_early);
  Random random(seed);
  for (std::uint64_t i = 0; i < cases && !tally.done(); ++i) {
    const A2rtPrecision& precision = some_precision(random);
    const FloatFormat f = precision.direction;
    const RayQuantizer quantizer(precision);
    const double left = round_to(random.magnitude(-20, 14, false), f, Rounding::kTowardZero);
    const double shift = random.chance(2) ? left * random.magnitude(-25, -21, false)
                                          : random.magnitude(-40, 20, false);
    const float t_shift = static_cast<float>(shift);
    const float t_closest = round_up(left + static_cast<double>(t_shift));
    tally.check(remaining_is_late(quantizer.remaining(t_closest, t_shift), t_closest, t_shift,
                                  max_finite(f)),
                [&] {
                  return name_of(precision) + ": " + std::to_string(t_closest) + " - " +
                         std::to_string(t_shift);
                });
  }
  return tally.result();
}

PropertyResult check_qbox(std::uint64_t seed, std::uint64_t cases, bool stop_early) {
  return over_cases(
      seed, cases, stop_early,
      [](Tally& tally, Random& random, const Stratum& s, const TestGroup& group,
         const TestRay& ray) {
        const A2rtPrecision& precision = some_precision(random);
        const RayQuantizer quantizer(precision);
        const QBoxReference tester(precision);
        const GroupFrame frame = make_group_frame(group.box, precision);
        const SlabRay slab = make_slab_ray(ray.origin, ray.direction, ray.tmin);
        const SlabHit entry = slab_test(slab, group.box, ray.tmax);
        const OracleRay oracle(ray.origin, ray.direction, ray.tmin);
        GroupRay local;
        const QuantizerRay q = make_quantizer_ray(ray.origin, ray.direction);
        const bool quantized =
            entry.hit && quantizer.enter(q, frame, entry.t_entry, local) == GroupEntry::kQuantized;
        for (const Box& child : group.children) {
          if (!ray_meets_box(oracle, child, ray.tmax)) {
            continue;
          }
          const QuantizedBox stored = quantize_box(child, group.box, frame, precision);
          const auto say = [&] {
            return name_of(s) + ", " + name_of(precision) + ": " + describe(ray) + ", group " +
                   describe(group.box) + ", child " + describe(child);
          };
          const bool hit =
              entry.hit &&
              (quantized
                   ? tester.test(local, stored, quantizer.remaining(ray.tmax, entry.t_entry)).hit
                   : slab_test(slab, dequantize_box(stored, frame, precision), ray.tmax).hit);
          tally.check(hit, say);
        }
      });
}

bool encloses(const Box& outer, const Box& inner) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (outer.lo[a] > inner.lo[a] || outer.hi[a] < inner.hi[a]) {
      return false;
    }
  }
  return true;
}

PropertyResult check_pow2(std::uint64_t seed, std::uint64_t cases, bool stop_early) {
  return over_cases(
      seed, cases, stop_early,
      [](Tally& tally, Random& random, const Stratum& s, const TestGroup& group, const TestRay&) {
        const Pow2Frame frame = make_pow2_frame(group.box);
        const Box& child = group.children[random.below(kChildren)];
        const Pow2Box q = quantize_pow2(child, frame);
        const auto say = [&] {
          return name_of(s) + ": " + describe(group.box) + ", child " + describe(child);
        };
        tally.check(encloses(dequantize_pow2(q, frame), child), say);
        for (std::size_t a = 0; a < 3; ++a) {
          const Rational step = Rational(std::ldexp(1.0, frame.exponent[a]));
          const Rational extent = Rational(group.box.hi[a]) - Rational(group.box.lo[a]);
          tally.check(255 * step >= extent, say);
          // Not larger than necessary.
          tally.check(frame.exponent[a] == -126 || 255 * step < 2 * extent, say);
        }
      });
}

}  // namespace

const std::vector<Property>& all_properties() {
  static const std::vector<Property> all{
      {"DirectedOperationsAreTheCorrectlyRoundedOnes", check_directed},
      {"SmallFormatsBracketEveryValue", check_formats},
      {"ColumnsBoundTheExactIntegerProduct", check_columns},
      {"ProductsBoundTheExactProduct", check_products},
      {"FramesAndStoredBoxesContainTheExactBoxes", check_frames_and_boxes},
      {"SlabTestNeverMissesAndEntersEarly", check_slab},
      {"SlabTestKeepsGrazedEdges", check_slab_edges},
      {"QuantizedRayContainsTheExactRay", check_ray_quantizer},
      {"WhatRemainsOfARayIsNeverTooShort", check_remaining},
      {"QuantizedTestNeverMisses", check_qbox},
      {"PowerOfTwoGridsContainTheExactBoxes", check_pow2},
  };
  return all;
}

const std::vector<A2rtPrecision>& conservative_precisions() {
  static const std::vector<A2rtPrecision> all = [] {
    std::vector<A2rtPrecision> list;
    for (const OriginDesign origin : {OriginDesign::kWide, OriginDesign::kGuard}) {
      A2rtPrecision p;
      p.origin = origin;
      list.push_back(p);  // the defaults, several times: they matter most
      list.push_back(p);
      for (const int bits : {4, 6, 10, 12}) {
        A2rtPrecision q = p;
        q.box_bits = bits;
        list.push_back(q);
      }
      for (const int k : {0, 1, 8}) {
        A2rtPrecision q = p;
        q.multiplier_columns = k;
        q.low_columns = k == 1 ? LowColumns::kDrop : LowColumns::kCompress;
        list.push_back(q);
      }
      for (const FloatFormat f : {kFp16, kFp32, reduced_significand(5), reduced_significand(10)}) {
        A2rtPrecision q = p;
        q.direction = f;
        list.push_back(q);
      }
      A2rtPrecision single = p;
      single.scales = ScaleSharing::kSingle;
      list.push_back(single);
    }
    A2rtPrecision broad;
    broad.origin_bits = 14;
    list.push_back(broad);
    A2rtPrecision narrow;
    narrow.origin_bits = 9;
    list.push_back(narrow);
    return list;
  }();
  return all;
}

std::string name_of(const A2rtPrecision& p) {
  return a2rt::arith::name_of(p.origin) + " b" + std::to_string(p.box_bits) + " o" +
         std::to_string(p.effective_origin_bits()) + " " + a2rt::arith::name_of(p.direction) + " " +
         a2rt::arith::name_of(p.rounding) + " " + a2rt::arith::name_of(p.scales) + " k" +
         std::to_string(p.multiplier_columns) + " " + a2rt::arith::name_of(p.low_columns);
}

}  // namespace a2rt::arith::testing
