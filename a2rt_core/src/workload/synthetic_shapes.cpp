#include "synthetic_shapes.h"

#include <cmath>
#include <numbers>

#include "a2rt/base/inverse.h"

namespace a2rt::synthetic {

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

float dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

Vec3 mix(const Vec3& a, const Vec3& b, float s) {
  return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

Vec3 normalized(const Vec3& v) {
  const float scale = 1.0f / std::sqrt(dot(v, v));
  return {v.x * scale, v.y * scale, v.z * scale};
}

Vec3 Random::direction() {
  for (;;) {
    const Vec3 v = in_box(-1, 1);
    const float length2 = dot(v, v);
    if (length2 > 1e-4f && length2 <= 1) {
      return normalized(v);
    }
  }
}

namespace {

std::vector<Triangle> soup(std::uint32_t count, float least_length, float most_length,
                           float least_width, float most_width, Random& random) {
  std::vector<Triangle> triangles;
  triangles.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 along = random.direction();
    const Vec3 across = normalized(cross(along, mix(along, random.direction(), 2)));
    const float length = random.between(least_length, most_length);
    const float width = random.between(least_width, most_width);
    const float reach = 1 - length - width;
    const Vec3 a = random.in_box(-reach, reach);
    triangles.push_back(
        {{a, mix(a, along, length), mix(mix(a, along, length / 2), across, width)}});
  }
  return triangles;
}

// Two triangles per cell of a rows x columns lattice of points.
template <class Point>
std::vector<Triangle> lattice(std::uint32_t rows, std::uint32_t columns, Point&& point) {
  std::vector<Triangle> triangles;
  triangles.reserve(std::size_t{2} * rows * columns);
  for (std::uint32_t r = 0; r < rows; ++r) {
    for (std::uint32_t c = 0; c < columns; ++c) {
      const Vec3 a = point(r, c), b = point(r + 1, c), d = point(r, c + 1), e = point(r + 1, c + 1);
      triangles.push_back({{a, b, d}});
      triangles.push_back({{d, b, e}});
    }
  }
  return triangles;
}

// Cells per side so that the lattice, less a sphere's flat triangles at the poles, has enough.
std::uint32_t side_of(const Config& config) {
  const std::uint64_t flat = config.shape == Shape::kSphere ? 1 : 0;
  std::uint64_t side = 3;
  while (2 * side * (side - flat) < config.primitives) {
    ++side;
  }
  return static_cast<std::uint32_t>(side);
}

Vec3 spherical(double latitude, double longitude) {
  return {static_cast<float>(std::sin(latitude) * std::cos(longitude)),
          static_cast<float>(std::cos(latitude)),
          static_cast<float>(std::sin(latitude) * std::sin(longitude))};
}

Vec3 toroidal(double around, double tube) {
  const double ring = 0.7 + 0.3 * std::cos(tube);
  return {static_cast<float>(ring * std::cos(around)), static_cast<float>(0.3 * std::sin(tube)),
          static_cast<float>(ring * std::sin(around))};
}

// The last row and column repeat the first bit for bit, so that closed meshes are closed.
std::vector<Triangle> closed(Shape shape, std::uint32_t side) {
  const double step = 2 * std::numbers::pi / side;
  if (shape == Shape::kTorus) {
    return lattice(side, side, [&](std::uint32_t r, std::uint32_t c) {
      return toroidal(step * (r % side), -step * (c % side));
    });
  }
  return lattice(side, side, [&](std::uint32_t r, std::uint32_t c) {
    if (r == 0 || r == side) {
      return Vec3{0, r == 0 ? 1.0f : -1.0f, 0};
    }
    return spherical(step / 2 * r, -step * (c % side));
  });
}

bool has_area(const Triangle& t) {
  return !(t.v[0] == t.v[1]) && !(t.v[1] == t.v[2]) && !(t.v[2] == t.v[0]);
}

Affine random_map(std::uint32_t index, Random& random) {
  const Vec3 z = random.direction();
  const Vec3 x = normalized(cross(z, mix(z, random.direction(), 2)));
  const Vec3 y = cross(z, x);
  const Vec3 axes[3] = {x, y, z};
  const Vec3 place = random.in_box(-2, 2);
  Affine map;
  for (std::size_t c = 0; c < 3; ++c) {
    const float scale = random.between(0.25f, 1.5f) * (index % 3 == 1 && c == 0 ? -1.0f : 1.0f);
    for (std::size_t r = 0; r < 3; ++r) {
      map.m[r][c] = axes[c][r] * scale;
    }
  }
  for (std::size_t r = 0; r < 3; ++r) {
    map.m[r][1] += index % 5 == 4 ? 0.5f * map.m[r][0] : 0.0f;
    map.m[r][3] = place[r];
  }
  return map;
}

}  // namespace

std::vector<Triangle> make_triangles(const Config& config, Random& random) {
  const std::uint32_t side = side_of(config);
  switch (config.shape) {
    case Shape::kSphere:
    case Shape::kTorus: {
      std::vector<Triangle> triangles = closed(config.shape, side);
      std::erase_if(triangles, [](const Triangle& t) { return !has_area(t); });
      return triangles;
    }
    case Shape::kGrid:
      return lattice(side, side, [&](std::uint32_t r, std::uint32_t c) {
        const auto at = [&](std::uint32_t i) {
          return -1 + 2 * static_cast<float>(i) / static_cast<float>(side);
        };
        return Vec3{at(c), at(r), 0};
      });
    case Shape::kSlivers:
      return soup(config.primitives, 0.2f, 0.9f, 1e-6f, 1e-3f, random);
    default:
      return soup(config.primitives, 0.01f, 0.2f, 0.01f, 0.1f, random);
  }
}

std::vector<Box> make_boxes(const Config& config, Random& random) {
  std::vector<Box> boxes;
  boxes.reserve(config.primitives);
  for (std::uint32_t i = 0; i < config.primitives; ++i) {
    const float radius = random.between(0.01f, 0.1f);
    const Vec3 centre = random.in_box(-1 + radius, 1 - radius);
    Box box;
    box.include(mix(centre, {1, 1, 1}, -radius));
    box.include(mix(centre, {1, 1, 1}, radius));
    boxes.push_back(box);
  }
  return boxes;
}

std::vector<Instance> make_instances(const Config& config, Random& random) {
  std::vector<Instance> instances(config.instances);
  for (std::uint32_t i = 0; i < config.instances; ++i) {
    instances[i].blas = 0;
    instances[i].custom_index = i;
    if (i > 0) {
      instances[i].object_to_world = random_map(i, random);
      instances[i].world_to_object = inverse(instances[i].object_to_world);
      instances[i].flags = i % 4 == 3 ? kInstanceFlipFacing : 0u;
      instances[i].mask = i % 7 == 6 ? 0x0fu : 0xffu;
    }
  }
  return instances;
}

}  // namespace a2rt::synthetic
