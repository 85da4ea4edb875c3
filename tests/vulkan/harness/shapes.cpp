// The geometry that the foreign programs draw.
#include <cmath>

#include "harness/app.h"

namespace foreign {

VkTransformMatrixKHR translation(float x, float y, float z) {
  return {{{1, 0, 0, x}, {0, 1, 0, y}, {0, 0, 1, z}}};
}

Mesh wavy_grid(std::uint32_t n) {
  Mesh mesh;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(n) * 2 - 1;
      const float v = static_cast<float>(y) / static_cast<float>(n) * 2 - 1;
      mesh.positions.insert(mesh.positions.end(), {u, v, 0.2f * std::sin(5 * u) * std::cos(4 * v)});
    }
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x;
      mesh.indices.insert(mesh.indices.end(), {a, a + 1, a + n + 2, a, a + n + 2, a + n + 1});
    }
  }
  return mesh;
}

Mesh cube() {
  Mesh mesh;
  for (std::uint32_t i = 0; i < 8; ++i) {
    mesh.positions.insert(mesh.positions.end(),
                          {static_cast<float>(i & 1) - 0.5f, static_cast<float>(i >> 1 & 1) - 0.5f,
                           static_cast<float>(i >> 2) - 0.5f});
  }
  mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return mesh;
}

Mesh sphere(std::uint32_t n) {
  Mesh mesh;
  const float pi = std::acos(-1.0f);
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      const float a = 2 * pi * static_cast<float>(x) / static_cast<float>(n);
      const float b = pi * static_cast<float>(y) / static_cast<float>(n);
      mesh.positions.insert(
          mesh.positions.end(),
          {0.5f * std::sin(b) * std::cos(a), 0.5f * std::cos(b), 0.5f * std::sin(b) * std::sin(a)});
    }
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x;
      mesh.indices.insert(mesh.indices.end(), {a, a + 1, a + n + 2, a, a + n + 2, a + n + 1});
    }
  }
  return mesh;
}

}  // namespace foreign
