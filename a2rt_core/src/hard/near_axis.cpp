#include "a2rt/hard/near_axis.h"

#include <algorithm>
#include <cmath>

#include "a2rt/arith/oracle.h"
#include "a2rt/hard/strata.h"

namespace a2rt::hard {
namespace {

using namespace arith;

struct AimedRay {
  Box anchor, child;
  Vec3 origin, direction;
};

// A ray through a random point of a random child box, its y component +-2^exponent or so.
AimedRay draw(Random& random, int exponent) {
  AimedRay r;
  Vec3 target;
  for (std::size_t a = 0; a < 3; ++a) {
    const float lo = 10 * random.signed_unit();
    r.anchor.lo[a] = lo;
    r.anchor.hi[a] = lo + 0.1F + 4 * random.unit();
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const float extent = r.anchor.hi[a] - r.anchor.lo[a];
    const float lo = r.anchor.lo[a] + random.unit() * extent * 0.9F;
    r.child.lo[a] = lo;
    r.child.hi[a] = std::min(r.anchor.hi[a], lo + random.unit() * extent * 0.5F);
    target[a] = r.child.lo[a] + random.unit() * (r.child.hi[a] - r.child.lo[a]);
  }
  const float quarter = static_cast<float>(random.below(4)) + 0.01F + 0.98F * random.unit();
  const float angle = 1.5707963F * quarter;  // x and z stay ordinary
  const float small = random.magnitude(exponent, exponent, true);
  const float rest = std::sqrt(1 - small * small);
  r.direction = {std::cos(angle) * rest, small, std::sin(angle) * rest};
  const float t = 5 + 20 * random.unit();
  for (std::size_t a = 0; a < 3; ++a) {
    r.origin[a] = target[a] - t * r.direction[a];
  }
  return r;
}

}  // namespace

LossRate aqb8_near_axis_loss(int exponent, Aqb8Rounding rounding, std::uint32_t rays) {
  Random random(static_cast<std::uint64_t>(1000 - exponent));
  LossRate loss;
  for (std::uint32_t i = 0; i < rays; ++i) {
    const AimedRay r = draw(random, exponent);
    if (!ray_meets_box(OracleRay(r.origin, r.direction, 0), r.child, Box::kInf)) {
      continue;
    }
    ++loss.hits;
    const Aqb8Anchor anchor = make_aqb8_anchor(r.anchor);
    const Aqb8Ray ray = make_aqb8_ray(r.origin, r.direction, 0);
    const Aqb8Entry entry = aqb8_anchor_test(ray, anchor, Box::kInf);
    if (!entry.hit) {
      ++loss.missed_anchors;
      continue;
    }
    const Aqb8Local local = aqb8_enter(ray, anchor, entry.y_ref, Box::kInf, rounding);
    loss.missed += aqb8_test(ray, local, quantize_aqb8(r.child, anchor)).hit ? 0U : 1U;
  }
  return loss;
}

const std::vector<NearAxisRow>& aqb8_near_axis_table() {
  static const std::vector<NearAxisRow> rows{{-17, 5}, {-18, 31}, {-20, 60}, {-28, 77}, {-33, 100}};
  return rows;
}

}  // namespace a2rt::hard
