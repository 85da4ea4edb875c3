#include "verdicts.h"

#include "a2rt/arith/aqb8_arith.h"
#include "a2rt/arith/oracle.h"
#include "a2rt/arith/pow2_frame.h"
#include "a2rt/arith/qbox.h"
#include "a2rt/arith/slab.h"

namespace a2rt::arith::hard {
namespace {

Verdict grade(bool truth, bool said) {
  return truth == said ? Verdict::kExact : said ? Verdict::kConservative : Verdict::kMisses;
}

struct A2rtAnswer {
  bool hit = false, escaped = false;
  float t_shift = 0;
};

A2rtAnswer ask_a2rt(const Case& c, const A2rtPrecision& precision) {
  A2rtAnswer answer;
  const SlabRay slab = make_slab_ray(c.origin, c.direction, c.tmin);
  const SlabHit entry = precision.origin == OriginDesign::kLiteral
                            ? slab_test_plain(slab, c.group, c.tmax)
                            : slab_test(slab, c.group, c.tmax);
  if (!entry.hit) {
    return answer;
  }
  answer.t_shift = entry.t_entry;
  const GroupFrame frame = make_group_frame(c.group, precision);
  const QuantizedBox stored = quantize_box(c.child, c.group, frame, precision);
  const RayQuantizer quantizer(precision);
  GroupRay local;
  const GroupEntry how =
      quantizer.enter(make_quantizer_ray(c.origin, c.direction), frame, entry.t_entry, local);
  answer.escaped = how == GroupEntry::kEscaped;
  answer.hit = answer.escaped
                   ? slab_test(slab, dequantize_box(stored, frame, precision), c.tmax).hit
                   : QBoxReference(precision)
                         .test(local, stored, quantizer.remaining(c.tmax, entry.t_entry))
                         .hit;
  return answer;
}

Verdict ask_aqb8(const Case& c, bool truth, Aqb8Rounding rounding) {
  if (!aqb8_can_anchor(c.group)) {
    return Verdict::kRefuses;
  }
  const Aqb8Anchor anchor = make_aqb8_anchor(c.group);
  const Aqb8Ray ray = make_aqb8_ray(c.origin, c.direction, c.tmin);
  const Aqb8Entry entry = aqb8_anchor_test(ray, anchor, c.tmax);
  const bool hit =
      entry.hit && aqb8_test(ray, aqb8_enter(ray, anchor, entry.y_ref, c.tmax, rounding),
                             quantize_aqb8(c.child, anchor))
                       .hit;
  return grade(truth, hit);
}

}  // namespace

std::string name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kExact:
      return "exact";
    case Verdict::kConservative:
      return "conservative";
    case Verdict::kMisses:
      return "misses";
    default:
      return "refuses";
  }
}

Verdicts judge(const Case& c) {
  Verdicts v;
  v.truth = ray_meets_box(OracleRay(c.origin, c.direction, c.tmin), c.child, c.tmax);
  const SlabRay slab = make_slab_ray(c.origin, c.direction, c.tmin);
  v.baseline = grade(v.truth, slab_test(slab, c.child, c.tmax).hit);
  A2rtPrecision precision;
  const A2rtAnswer wide = ask_a2rt(c, precision);
  v.wide = grade(v.truth, wide.hit);
  v.wide_escaped = wide.escaped;
  v.t_shift = wide.t_shift;
  precision.origin = OriginDesign::kGuard;
  const A2rtAnswer guard = ask_a2rt(c, precision);
  v.guard = grade(v.truth, guard.hit);
  v.guard_escaped = guard.escaped;
  precision.origin = OriginDesign::kLiteral;
  v.literal = grade(v.truth, ask_a2rt(c, precision).hit);
  precision = {};
  precision.rounding = QuantRounding::kNearest;
  v.nearest = grade(v.truth, ask_a2rt(c, precision).hit);
  v.aqb8 = ask_aqb8(c, v.truth, Aqb8Rounding::kFloorCeil);
  v.aqb8_rtl = ask_aqb8(c, v.truth, Aqb8Rounding::kNearestEven);
  const Pow2Frame frame = make_pow2_frame(c.group);
  const Box grid = dequantize_pow2(quantize_pow2(c.child, frame), frame);
  v.pow2 = grade(v.truth, slab_test(slab, grid, c.tmax).hit);
  return v;
}

bool Verdicts::kept() const {
  for (const Verdict v : {baseline, wide, guard, pow2}) {
    if (v == Verdict::kMisses) {
      return false;
    }
  }
  return true;
}

bool Verdicts::separated() const {
  for (const Verdict v : {baseline, wide, guard, pow2}) {
    if (v != Verdict::kExact) {
      return false;
    }
  }
  return !truth;
}

std::string Verdicts::describe() const {
  return std::string("truth ") + (truth ? "hit" : "miss") + ": baseline " + name_of(baseline) +
         ", wide " + name_of(wide) + (wide_escaped ? " (escaped)" : "") + ", guard " +
         name_of(guard) + (guard_escaped ? " (escaped)" : "") + ", literal " + name_of(literal) +
         ", nearest " + name_of(nearest) + ", aqb8 " + name_of(aqb8) + ", aqb8 rtl " +
         name_of(aqb8_rtl) + ", cwbvh/clbvh " + name_of(pow2);
}

}  // namespace a2rt::arith::hard
