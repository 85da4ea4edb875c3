// Extents: flat, denormal, near FLT_MAX, points, slivers, coincident faces, deep nesting.
#include <cmath>

#include "case_builder.h"
#include "cases.h"

namespace a2rt::hard {
namespace {

Workload flat() {
  CaseBuilder c(21);
  std::vector<Triangle> triangles;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    add_flat_grid(triangles, axis, 0.3F * static_cast<float>(axis), 10);
  }
  c.blas(std::move(triangles));
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    const Vec3 target = c.surface_point();
    Vec3 d = c.random().direction();
    if (i % 3 == 0) {
      d = {};
      d[i / 3 % 3] = i % 2 == 0 ? 1.0F : -1.0F;
    }
    c.ray(target - 2 * d, d);
  }
  return c.finish();
}

// Rays that run within the plane of the grid they aim at.
Workload in_plane() {
  CaseBuilder c(22);
  std::vector<Triangle> triangles;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    add_flat_grid(triangles, axis, 0.25F * static_cast<float>(axis), 10);
  }
  c.blas(std::move(triangles));
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    const std::size_t axis = i % 3;
    Vec3 d = c.random().direction(), target = c.random().in_box(-1, 1);
    d[axis] = i % 2 == 0 ? 0.0F : -0.0F;
    Vec3 origin = target - 3 * d;
    origin[axis] = 0.25F * static_cast<float>(axis);
    c.ray(origin, d);
  }
  return c.finish();
}

// A soup of triangles about `scale` wide, rays from three scales away.
Workload scaled(std::uint64_t seed, float scale, float reach) {
  CaseBuilder c(seed);
  c.blas(soup(600, 0.25F, scale, seed));
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    Vec3 d = c.random().direction();
    const Vec3 target = c.surface_point();
    if (i % 4 == 0) {
      d = {};
      d[i / 4 % 3] = i % 8 == 0 ? 1.0F : -1.0F;
    }
    c.ray(target - (reach * scale) * d, d);
  }
  return c.finish();
}
Workload denormal_extents() { return scaled(23, 0x1p-137F, 3); }
// Triangles at +-0.9 FLT_MAX: the extents of boxes overflow FP32.
Workload huge_extents() { return scaled(24, 0x1.cp127F, 0.05F); }

// Three equal vertices: boxes without extent on any axis.
Workload points() {
  CaseBuilder c(25);
  std::vector<Triangle> triangles = soup(200, 0.25F, 1, 25);
  for (std::uint32_t i = 0; i < 300; ++i) {
    const Vec3 p = c.random().in_box(-1, 1);
    triangles.push_back({{p, p, p}});
  }
  c.blas(std::move(triangles));
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    const Vec3 target = c.triangles()[200 + i % 300].v[0];
    Vec3 d = c.random().direction();
    if (i % 2 == 0) {
      d = {};
      d[i / 2 % 3] = 1;
    }
    c.ray(target - 2 * d, d);
  }
  return c.finish();
}

Workload slivers() {
  CaseBuilder c(26);
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < 500; ++i) {
    const Vec3 a = c.random().in_box(-1, 1);
    Vec3 along = c.random().direction();
    if (i % 2 == 0) {
      along = {};
      along[i / 2 % 3] = 1;
    }
    triangles.push_back({{a, a + along, a + 0.5F * along + 1e-6F * c.random().direction()}});
  }
  c.blas(std::move(triangles));
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    const Vec3 target = c.surface_point(), origin = 3 * c.random().direction();
    c.ray(origin, target - origin);
  }
  return c.finish();
}

Workload coincident() {
  CaseBuilder c(27);
  c.blas(stacked_cubes(5));
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    // Points of the lattice: shared faces, edges and corners.
    Vec3 target = 2.5F * (c.random().in_box(-1, 1) + Vec3{1, 1, 1});
    for (std::size_t a = 0; a < 3; ++a) {
      target[a] = (i >> a & 1U) != 0 ? std::floor(target[a]) : target[a];
    }
    Vec3 d = c.random().direction();
    if (i % 3 == 0) {
      d = {};
      d[i / 3 % 3] = i % 2 == 0 ? 1.0F : -1.0F;
    }
    c.ray(target - 8 * d, d);
  }
  return c.finish();
}

// Each level is an eighth of the one around it: every one opens a group inside a group.
Workload nested() {
  CaseBuilder c(28);
  std::vector<Triangle> triangles;
  float scale = 1;
  constexpr std::uint32_t kLevels = 16;
  for (std::uint32_t level = 0; level < kLevels; ++level, scale /= 8) {
    for (std::uint32_t i = 0; i < 24; ++i) {
      const Vec3 p = scale * c.random().direction();
      triangles.push_back({{p, p + (0.3F * scale) * c.random().direction(),
                            p + (0.3F * scale) * c.random().direction()}});
    }
  }
  c.blas(std::move(triangles));
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    const Vec3 target = c.surface_point();
    Vec3 d = c.random().direction();
    if (i % 4 == 0) {
      d = {};
      d[i / 4 % 3] = 1;
    }
    c.ray(target - 2 * d, d);
  }
  return c.finish();
}

}  // namespace

std::vector<HardCase> extent_cases() {
  const std::string group = "Extents";
  return {
      {"flat", group, "Flat groups", "Grids without extent on one axis, hit from all sides.", flat},
      {"in_plane", group, "Rays in the plane of a face",
       "The same grids; each ray runs exactly within one grid's plane.", in_plane},
      {"denormal_extent", group, "Denormal extents",
       "600 triangles about 2^-137 wide, rays from as near.", denormal_extents},
      {"huge_extent", group, "Extents near FLT_MAX",
       "600 triangles up to ±0.9 FLT_MAX: box extents overflow FP32.", huge_extents},
      {"points", group, "Boxes without any extent",
       "300 triangles with three equal vertices among 200 others; rays through them.", points},
      {"slivers", group, "Slivers",
       "Triangles a million times longer than wide, rays at their edges and vertices.", slivers},
      {"coincident", group, "Coincident faces",
       "125 cubes that share faces; rays through shared faces, edges and corners.", coincident},
      {"nested", group, "Deep nesting of groups",
       "16 shells, each an eighth of the one around it: groups in groups down to 2^-45.", nested}};
}

}  // namespace a2rt::hard
