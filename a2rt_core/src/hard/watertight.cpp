#include "a2rt/hard/watertight.h"

#include <cmath>
#include <numbers>

#include "a2rt/workload/driver_triangle.h"
#include "a2rt/workload/reference.h"
#include "case_builder.h"

namespace a2rt::hard {
namespace {

using synthetic::Shape;

// Points on the edges of a triangle besides its vertices: shares of the way from vertex to vertex.
constexpr float kShares[] = {0.5F, 0.25F, 0.3F};

// Rays from `origins` points given by `inside` to every vertex and some points of every edge.
template <class Inside>
void aim(CaseBuilder& c, std::uint32_t origins, const Affine& to_world, const Inside& inside) {
  for (std::uint32_t k = 0; k < origins; ++k) {
    const Vec3 origin = driver_transform_point(to_world, inside(c.random()));
    for (const Triangle& t : c.triangles()) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 a = driver_transform_point(to_world, t.v[i]);
        const Vec3 b = driver_transform_point(to_world, t.v[(i + 1) % 3]);
        c.ray(origin, a - origin);
        const float share = kShares[(k + i) % 3];
        c.ray(origin, ((1 - share) * a + share * b) - origin);
      }
    }
  }
}

std::vector<Triangle> shape(Shape shape, std::uint32_t primitives) {
  synthetic::Config config;
  config.shape = shape;
  config.primitives = primitives;
  config.width = config.height = 1;
  config.secondary = 0;
  config.reference = false;
  return synthetic::make(config).blas[0].triangles;
}

Vec3 near_centre(synthetic::Random& random) { return random.in_box(-0.3F, 0.3F); }

Workload sphere(std::uint32_t origins) {
  CaseBuilder c(61);
  c.blas(shape(Shape::kSphere, 2000));
  aim(c, origins, {}, near_centre);
  return c.finish();
}

Workload turned_sphere(std::uint32_t origins) {
  // A turn about (1, 1, 1), uneven scales and a shear.
  const Affine map{{{0.3F, 0.8F, -0.4F, 10}, {0.7F, -0.2F, 0.5F, -3}, {-0.1F, 0.6F, 0.9F, 0.5F}}};
  CaseBuilder c(62);
  const std::uint32_t blas = c.blas(shape(Shape::kSphere, 2000));
  c.instance(blas, map);
  aim(c, origins, map, near_centre);
  return c.finish();
}

Workload torus(std::uint32_t origins) {
  CaseBuilder c(63);
  c.blas(shape(Shape::kTorus, 2000));
  // The circle in the middle of the tube: radius 0.7, tube 0.3.
  aim(c, origins, {}, [](synthetic::Random& random) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(random.unit());
    return Vec3{static_cast<float>(0.7 * std::cos(angle)), random.between(-0.1F, 0.1F),
                static_cast<float>(0.7 * std::sin(angle))};
  });
  return c.finish();
}

Workload cube(std::uint32_t origins) {
  CaseBuilder c(64);
  c.blas(subdivided_cube({{-1, -1, -1}, {1, 1, 1}}, 13));
  // Every other origin on the grid's own lines: rays parallel to the faces and to the axes.
  aim(c, origins, {}, [](synthetic::Random& random) {
    Vec3 p = random.in_box(-0.9F, 0.9F);
    if (random.below(2) == 0) {
      for (std::size_t a = 0; a < 3; ++a) {
        p[a] = -1 + 2.0F * static_cast<float>(1 + random.below(12)) / 13;
      }
    }
    return p;
  });
  return c.finish();
}

// Vertices of the box, and two points of each of four edges.
void box_points(const Box& box, std::vector<Vec3>& points) {
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec3 p;
    for (std::size_t a = 0; a < 3; ++a) {
      p[a] = (corner >> a & 1U) != 0 ? box.hi[a] : box.lo[a];
    }
    points.push_back(p);
    p.x = 0.5F * box.lo.x + 0.5F * box.hi.x;
    points.push_back(p);
  }
}

// A point to aim at: on an edge or a vertex of a random primitive of a random instance, in the
// world.
bool edge_point(const Workload& w, synthetic::Random& random, std::uint32_t i, Vec3& target) {
  const std::vector<Instance>& instances = w.tlas[0].instances;
  const Instance& instance = instances[random.below(static_cast<std::uint32_t>(instances.size()))];
  if (instance.blas == kNone || w.blas[instance.blas].primitive_count() == 0) {
    return false;
  }
  const Blas& blas = w.blas[instance.blas];
  const std::uint32_t slot = random.below(blas.primitive_count());
  Vec3 p;
  if (blas.procedural()) {
    std::vector<Vec3> points;
    box_points(blas.aabbs[slot], points);
    p = points[random.below(static_cast<std::uint32_t>(points.size()))];
  } else {
    const Triangle& t = blas.triangles[slot];
    const float share = i % 2 == 0 ? 0.0F : kShares[i / 2 % 3];
    p = (1 - share) * t.v[i % 3] + share * t.v[(i + 1) % 3];
  }
  target = driver_transform_point(instance.object_to_world, p);
  return true;
}

}  // namespace

const std::vector<ClosedMesh>& closed_meshes() {
  static const std::vector<ClosedMesh> all{
      {"sphere", "Sphere, 2,000 triangles", sphere},
      {"turned_sphere", "The same, turned, scaled and sheared by its instance", turned_sphere},
      {"torus", "Torus, 2,000 triangles", torus},
      {"cube", "Subdivided cube, 2,028 triangles", cube}};
  return all;
}

Leaks count_leaks(const UnitColumn& column, const Workload& closed) {
  const std::unique_ptr<RtUnit> unit = make_unit(column);
  unit->build(closed);
  Leaks leaks;
  for (const Ray& ray : closed.rays) {
    ++leaks.rays;
    ++leaks.hits;
    leaks.leaked += unit->trace({&ray, {}}).state == HitState::kHit ? 0U : 1U;
  }
  return leaks;
}

Workload aim_at_edges(const Workload& captured, std::uint32_t rays, std::uint64_t seed) {
  Workload aimed;
  aimed.blas = captured.blas;
  aimed.tlas = {captured.tlas.at(0)};
  synthetic::Random random(seed);
  // Every candidate is a hit: what shaders say does not matter to a surface's closedness.
  for (std::uint32_t tries = 0; tries < 8 * rays && aimed.rays.size() < rays; ++tries) {
    const Ray& from = captured.rays[random.below(static_cast<std::uint32_t>(captured.rays.size()))];
    Vec3 target;
    if (from.tlas != 0 || !edge_point(captured, random, tries, target)) {
      continue;
    }
    Ray ray;
    ray.origin = from.origin;
    ray.dir = target - from.origin;
    ray.launch = static_cast<std::uint32_t>(aimed.rays.size());
    aimed.rays.push_back(ray);
  }
  Dispatch dispatch;
  dispatch.ray_count = aimed.rays.size();
  dispatch.width = static_cast<std::uint32_t>(aimed.rays.size());
  dispatch.height = 1;
  aimed.dispatches.push_back(dispatch);
  aimed.driver_hits.assign(aimed.rays.size(), {HitState::kUnknown, 0, kNone, kNone, kNone, 0});
  aimed.candidate_first.assign(aimed.rays.size() + 1, 0);
  return aimed;
}

Leaks count_leaks(const UnitColumn& column, const Workload& aimed, const std::vector<Hit>& truth) {
  const std::unique_ptr<RtUnit> unit = make_unit(column);
  unit->build(aimed);
  Leaks leaks;
  for (std::size_t i = 0; i < aimed.rays.size(); ++i) {
    Audit audit;
    const Hit found = unit->trace({&aimed.rays[i], {}}, audit);
    const bool hit = found.state == HitState::kHit;
    ++leaks.rays;
    leaks.missed += audit.missed_hits + audit.fp32_missed_hits;
    if (truth[i].state == HitState::kMiss) {
      continue;
    }
    ++leaks.hits;
    leaks.leaked += hit ? 0U : 1U;
    if (hit && found.t > truth[i].t) {
      ++(owes(aimed, aimed.rays[i], truth[i], found) ? leaks.farther : leaks.rounding_ties);
    }
  }
  return leaks;
}

}  // namespace a2rt::hard
