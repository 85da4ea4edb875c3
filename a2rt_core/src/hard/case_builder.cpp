#include "case_builder.h"

#include <utility>

#include "a2rt/base/inverse.h"

namespace a2rt::hard {

Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec3 operator*(float s, const Vec3& v) { return {s * v.x, s * v.y, s * v.z}; }

std::uint32_t CaseBuilder::blas(std::vector<Triangle> triangles) {
  Blas blas;
  blas.geometries.push_back({0, static_cast<std::uint32_t>(triangles.size()), true});
  blas.triangles = std::move(triangles);
  workload_.blas.push_back(std::move(blas));
  return static_cast<std::uint32_t>(workload_.blas.size() - 1);
}

std::uint32_t CaseBuilder::blas(std::vector<Box> boxes) {
  Blas blas;
  blas.geometries.push_back({0, static_cast<std::uint32_t>(boxes.size()), true});
  blas.aabbs = std::move(boxes);
  workload_.blas.push_back(std::move(blas));
  return static_cast<std::uint32_t>(workload_.blas.size() - 1);
}

void CaseBuilder::instance(std::uint32_t blas, const Affine& object_to_world) {
  Instance instance;
  instance.object_to_world = object_to_world;
  instance.world_to_object = object_to_world == Affine{} ? Affine{} : inverse(object_to_world);
  instance.blas = blas;
  instances_.push_back(instance);
}

void CaseBuilder::ray(const Vec3& origin, const Vec3& direction, float tmin, float tmax) {
  Ray ray;
  ray.origin = origin;
  ray.dir = direction;
  ray.tmin = tmin;
  ray.tmax = tmax;
  ray.launch = static_cast<std::uint32_t>(workload_.rays.size());
  workload_.rays.push_back(ray);
}

Workload CaseBuilder::finish() {
  if (instances_.empty()) {
    for (std::uint32_t b = 0; b < workload_.blas.size(); ++b) {
      instance(b);
    }
  }
  workload_.tlas.resize(1);
  workload_.tlas[0].instances = std::move(instances_);
  Dispatch dispatch;
  dispatch.ray_count = workload_.rays.size();
  dispatch.width = static_cast<std::uint32_t>(workload_.rays.size());
  dispatch.height = 1;
  workload_.dispatches.push_back(dispatch);
  workload_.driver_hits.assign(workload_.rays.size(),
                               {HitState::kUnknown, 0, kNone, kNone, kNone, 0});
  workload_.candidate_first.assign(workload_.rays.size() + 1, 0);
  return std::move(workload_);
}

Vec3 CaseBuilder::surface_point(std::uint32_t blas) {
  const std::vector<Triangle>& all = triangles(blas);
  const Triangle& t = all[random_.below(static_cast<std::uint32_t>(all.size()))];
  const std::uint32_t kind = random_.below(3), corner = random_.below(3);
  if (kind == 0) {
    return t.v[corner];
  }
  const float share = random_.unit();
  const Vec3 edge = (1 - share) * t.v[corner] + share * t.v[(corner + 1) % 3];
  if (kind == 1) {
    return edge;
  }
  const float inner = random_.unit();
  return (1 - inner) * edge + inner * t.v[(corner + 2) % 3];
}

std::vector<Triangle> soup(std::uint32_t count, float size, float scale, std::uint64_t seed) {
  synthetic::Random random(seed);
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 a = random.in_box(-1 + size, 1 - size);
    Triangle t;
    for (Vec3& v : t.v) {
      v = scale * (a + random.in_box(-size / 2, size / 2));
    }
    triangles.push_back(t);
  }
  return triangles;
}

namespace {

// The point of `box` whose coordinate on axis a is lo or hi by bit a of `corner`.
Vec3 corner_of(const Box& box, unsigned corner) {
  Vec3 p;
  for (std::size_t a = 0; a < 3; ++a) {
    p[a] = (corner >> a & 1U) != 0 ? box.hi[a] : box.lo[a];
  }
  return p;
}

float level_of(float lo, float hi, std::uint32_t step, std::uint32_t steps) {
  return step == steps ? hi : lo + (hi - lo) * static_cast<float>(step) / static_cast<float>(steps);
}

// Two triangles for the cell (u, v) of the face of `box` at `level` of `axis`.
void add_cell(std::vector<Triangle>& triangles, std::size_t axis, float level, const Box& box,
              std::uint32_t u, std::uint32_t v, std::uint32_t steps) {
  const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
  Vec3 p[4];
  for (unsigned i = 0; i < 4; ++i) {
    p[i][axis] = level;
    p[i][a] = level_of(box.lo[a], box.hi[a], u + (i & 1U), steps);
    p[i][b] = level_of(box.lo[b], box.hi[b], v + (i >> 1U), steps);
  }
  triangles.push_back({{p[0], p[1], p[2]}});
  triangles.push_back({{p[2], p[1], p[3]}});
}

}  // namespace

void add_box(std::vector<Triangle>& triangles, const Box& box) {
  // Faces as corner numbers, counter-clockwise seen from outside.
  static constexpr unsigned kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                            {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& f : kFaces) {
    const Vec3 p[4] = {corner_of(box, f[0]), corner_of(box, f[1]), corner_of(box, f[2]),
                       corner_of(box, f[3])};
    triangles.push_back({{p[0], p[1], p[2]}});
    triangles.push_back({{p[0], p[2], p[3]}});
  }
}

std::vector<Triangle> subdivided_cube(const Box& box, std::uint32_t steps) {
  std::vector<Triangle> triangles;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const float level : {box.lo[axis], box.hi[axis]}) {
      for (std::uint32_t u = 0; u < steps; ++u) {
        for (std::uint32_t v = 0; v < steps; ++v) {
          add_cell(triangles, axis, level, box, u, v, steps);
        }
      }
    }
  }
  return triangles;
}

std::vector<Triangle> stacked_cubes(std::uint32_t steps) {
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < steps * steps * steps; ++i) {
    const Vec3 lo{static_cast<float>(i % steps), static_cast<float>(i / steps % steps),
                  static_cast<float>(i / steps / steps)};
    add_box(triangles, {lo, lo + Vec3{1, 1, 1}});
  }
  return triangles;
}

void add_flat_grid(std::vector<Triangle>& triangles, std::size_t axis, float level,
                   std::uint32_t steps) {
  const Box square{{-1, -1, -1}, {1, 1, 1}};
  for (std::uint32_t u = 0; u < steps; ++u) {
    for (std::uint32_t v = 0; v < steps; ++v) {
      add_cell(triangles, axis, level, square, u, v, steps);
    }
  }
}

}  // namespace a2rt::hard
