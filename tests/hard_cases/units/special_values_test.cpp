// Every number of a ray, a vertex, a box and a transform, replaced by NaN, infinities, denormal and
// enormous values one at a time: what every unit answers is defined, and right if it promises so.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "a2rt/hard/judge.h"
#include "a2rt/workload/synthetic.h"

namespace a2rt::hard {
namespace {

using Limits = std::numeric_limits<float>;
constexpr float kSpecial[] = {Limits::quiet_NaN(),
                              -Limits::quiet_NaN(),
                              Limits::infinity(),
                              -Limits::infinity(),
                              Limits::denorm_min(),
                              -Limits::denorm_min(),
                              0x1.fffffcp-127F,
                              -0x1.fffffcp-127F,
                              Limits::min(),
                              Limits::max(),
                              -Limits::max(),
                              0.0F,
                              -0.0F};

struct Slot {
  std::string name;
  std::function<float&(Workload&)> number;
};

// A sphere of 60 triangles and three boxes beside it, each in an instance; twelve rays.
Workload plain_scene() {
  synthetic::Config config;
  config.shape = synthetic::Shape::kSphere;
  config.primitives = 60;
  config.width = 4;
  config.height = 3;
  config.secondary = 0;
  config.reference = false;
  Workload w = synthetic::make(config);
  w.rays.resize(12);
  w.driver_hits.resize(12);
  w.candidate_first.assign(13, 0);
  w.candidates.clear();
  Blas boxes;
  for (const float x : {-0.5F, 0.1F, 0.6F}) {
    boxes.aabbs.push_back({{x, -0.2F, 0.3F}, {x + 0.3F, 0.2F, 0.4F}});
  }
  boxes.geometries.push_back({0, 3, true});
  w.blas.push_back(boxes);
  Instance instance = w.tlas[0].instances[0];
  instance.blas = 1;
  w.tlas[0].instances.push_back(instance);
  return w;
}

std::vector<Slot> slots() {
  std::vector<Slot> all;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis(1, static_cast<char>('x' + a));
    all.push_back({"origin." + axis, [a](Workload& w) -> float& { return w.rays[0].origin[a]; }});
    all.push_back({"dir." + axis, [a](Workload& w) -> float& { return w.rays[0].dir[a]; }});
    all.push_back({"lo." + axis, [a](Workload& w) -> float& { return w.blas[1].aabbs[1].lo[a]; }});
    all.push_back({"hi." + axis, [a](Workload& w) -> float& { return w.blas[1].aabbs[1].hi[a]; }});
    for (std::size_t v = 0; v < 3; ++v) {
      all.push_back({"vertex" + std::to_string(v) + "." + axis,
                     [a, v](Workload& w) -> float& { return w.blas[0].triangles[7].v[v][a]; }});
    }
    for (std::size_t c = 0; c < 4; ++c) {
      all.push_back({"world_to_object." + axis + std::to_string(c), [a, c](Workload& w) -> float& {
                       return w.tlas[0].instances[0].world_to_object.m[a][c];
                     }});
      all.push_back({"object_to_world." + axis + std::to_string(c), [a, c](Workload& w) -> float& {
                       return w.tlas[0].instances[0].object_to_world.m[a][c];
                     }});
    }
  }
  all.push_back({"tmin", [](Workload& w) -> float& { return w.rays[0].tmin; }});
  all.push_back({"tmax", [](Workload& w) -> float& { return w.rays[0].tmax; }});
  return all;
}

void expect_defined(const Workload& w, const Ray& ray, const Hit& hit, const std::string& what) {
  EXPECT_NE(hit.state, HitState::kUnknown) << what;
  if (hit.state == HitState::kHit) {
    EXPECT_TRUE(hit.t >= ray.tmin && hit.t <= ray.tmax && std::isfinite(hit.t)) << what;
    ASSERT_LT(hit.instance, w.tlas[0].instances.size()) << what;
    EXPECT_LT(hit.primitive, w.blas[w.tlas[0].instances[hit.instance].blas].primitive_count())
        << what;
  }
}

class SpecialValues : public testing::TestWithParam<UnitColumn> {};

TEST_P(SpecialValues, LeaveTheResultDefinedWhereverTheyStand) {
  const UnitColumn& column = GetParam();
  const Workload plain = plain_scene();
  std::size_t judged = 0;
  for (const Slot& slot : slots()) {
    for (const float value : kSpecial) {
      Workload w = plain;
      slot.number(w) = value;
      const std::string what = column.key + ", " + slot.name + " = " + std::to_string(value);
      const std::vector<Hit> truth = true_hits(w);
      const Cell cell = judge(column, w, truth);
      const std::unique_ptr<RtUnit> unit = make_unit(column);
      const bool promises = unit->info().promise != Promise::kMayMiss;
      if (!cell.refusal.empty()) {
        EXPECT_FALSE(promises) << what << ": " << cell.refusal;
        continue;
      }
      ++judged;
      EXPECT_TRUE(!promises || cell.missed() + cell.lost == 0) << what;
      unit->build(w);
      for (const Ray& ray : w.rays) {
        expect_defined(w, ray, unit->trace({&ray, {}}), what);
      }
    }
  }
  EXPECT_GT(judged, slots().size() * std::size(kSpecial) / 2);
}

INSTANTIATE_TEST_SUITE_P(Units, SpecialValues, testing::ValuesIn(unit_columns()),
                         [](const auto& unit) { return unit.param.key; });

}  // namespace
}  // namespace a2rt::hard
