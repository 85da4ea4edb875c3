// Scenes: inactive primitives, equal distances, mirrored, sheared and singular instances.
#include <cmath>

#include "case_builder.h"
#include "cases.h"

namespace a2rt::hard {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

void random_rays(CaseBuilder& c) {
  for (std::uint32_t i = 0; i < kRaysPerCase; ++i) {
    const Vec3 origin = 4 * c.random().direction();
    Vec3 d = c.random().in_box(-1.5F, 1.5F) - origin;
    if (i % 5 == 0) {
      d[i / 5 % 3] = i % 2 == 0 ? 0.0F : -0.0F;
    }
    c.ray(origin, d);
  }
}

Workload inactive() {
  CaseBuilder c(51);
  std::vector<Triangle> triangles = soup(500, 0.25F, 1, 51);
  for (std::size_t i = 0; i < triangles.size(); i += 5) {
    Vec3* v = triangles[i].v;
    switch (i / 5 % 4) {
      case 0:
        v[0].x = kNan;
        break;
      case 1:
        v[1].y = kInfinity;
        break;
      case 2:
        v[2].z = -kInfinity;
        break;
      default:
        v[2] = v[1];  // degenerate
        break;
    }
  }
  c.blas(std::move(triangles));
  std::vector<Box> boxes;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const Vec3 lo = c.random().in_box(-1, 1);
    Box box{lo, lo + Vec3{0.1F, 0.1F, 0.1F}};
    if (i % 3 == 0) {
      std::swap(box.lo, box.hi);  // inverted
    } else if (i % 3 == 1) {
      box.lo.x = kNan;
    }
    boxes.push_back(box);
  }
  c.blas(std::move(boxes));
  random_rays(c);
  // Rays that are not numbers are as inactive as primitives.
  c.ray({kNan, 0, 0}, {1, 0, 0});
  c.ray({0, 0, 0}, {kInfinity, 0, 0});
  c.ray({0, 0, 0}, {1, 0, 0}, kNan);
  c.ray({0, 0, 0}, {1, 0, 0}, 0, kNan);
  c.ray({0, -kInfinity, 0}, {1, 0, 0});
  return c.finish();
}

// Each triangle twice: every hit is a tie, which the smallest id must win in every unit.
Workload ties() {
  CaseBuilder c(52);
  std::vector<Triangle> triangles = soup(300, 0.3F, 1, 52);
  add_flat_grid(triangles, 2, 0, 8);
  const std::vector<Triangle> once = triangles;
  triangles.insert(triangles.end(), once.begin(), once.end());
  const std::uint32_t blas = c.blas(std::move(triangles));
  c.instance(blas);
  c.instance(blas);
  random_rays(c);
  return c.finish();
}

// Eight instances of a soup under `map`, scattered.
template <class Map>
Workload instanced(std::uint64_t seed, const Map& map) {
  CaseBuilder c(seed);
  const std::uint32_t blas = c.blas(soup(300, 0.25F, 1, seed));
  for (std::uint32_t i = 0; i < 8; ++i) {
    Affine m = map(c.random(), i);
    const Vec3 place = c.random().in_box(-1, 1);
    for (std::size_t r = 0; r < 3; ++r) {
      m.m[r][3] = place[r];
    }
    c.instance(blas, m);
  }
  random_rays(c);
  return c.finish();
}

Workload mirrored() {
  return instanced(53, [](synthetic::Random& random, std::uint32_t i) {
    Affine m;
    for (std::size_t a = 0; a < 3; ++a) {
      m.m[a][a] = ((i + 1) >> a & 1U) != 0 ? -random.between(0.3F, 1) : random.between(0.3F, 1);
    }
    return m;
  });
}

Workload sheared() {
  return instanced(54, [](synthetic::Random& random, std::uint32_t i) {
    Affine m;
    for (std::size_t r = 0; r < 3; ++r) {
      m.m[r][r] = 0.5F;
      m.m[r][(r + 1) % 3] = random.between(-2, 2);
      m.m[r][(r + 2) % 3] = i % 2 == 0 ? random.between(-1, 1) * 1e-3F : 0.0F;
    }
    return m;
  });
}

// Half of the instances cannot be inverted (a zero row, equal rows, all zero), a quarter hardly.
Workload singular() {
  return instanced(55, [](synthetic::Random& random, std::uint32_t i) {
    Affine m;
    switch (i % 4) {
      case 0:
        m.m[2][2] = 0;
        break;
      case 1:
        for (std::size_t k = 0; k < 3; ++k) {
          m.m[1][k] = m.m[0][k] = random.between(-1, 1);
        }
        break;
      case 2:
        m.m[2][2] = 1e-6F;
        break;
      default:
        break;
    }
    return m;
  });
}

}  // namespace

std::vector<HardCase> scene_cases() {
  const std::string group = "Scenes";
  return {
      {"inactive", group, "Inactive primitives and rays",
       "NaN and infinite vertices, degenerate triangles, inverted boxes; rays that are no numbers.",
       inactive},
      {"ties", group, "Equal distances",
       "Every triangle four times, in two places of two instances: the smallest id must win.",
       ties},
      {"mirrored", group, "Mirrored instances", "Eight instances with negative scales.", mirrored},
      {"sheared", group, "Sheared instances", "Eight instances with shears up to 4.", sheared},
      {"singular", group, "Singular instances",
       "Maps of rank 2 and 1, and one that is almost singular, among plain instances.", singular}};
}

}  // namespace a2rt::hard
