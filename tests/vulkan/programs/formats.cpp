// Vertex and index formats, a transform, firstVertex and offsets, all in one BLAS.
#include <algorithm>
#include <cmath>

#include "harness/app.h"

namespace {
using namespace foreign;

std::uint16_t to_half(float value) {
  // Enough for numbers of this program: normal halves, and zero for what is smaller.
  if (std::fabs(value) < 1e-4f) {
    return 0;
  }
  int exponent = 0;
  const float mantissa = std::frexp(std::fabs(value), &exponent);
  const auto bits = static_cast<std::uint32_t>(std::lround((mantissa * 2 - 1) * 1024));
  const auto sign = static_cast<std::uint32_t>(value < 0 ? 0x8000 : 0);
  return static_cast<std::uint16_t>(sign + (static_cast<std::uint32_t>(exponent + 14) << 10) +
                                    bits);
}

template <class T, class Convert>
std::vector<T> convert(const Mesh& mesh, std::size_t components, const Convert& one) {
  std::vector<T> out;
  for (std::size_t v = 0; v < mesh.positions.size() / 3; ++v) {
    for (std::size_t i = 0; i < components; ++i) {
      out.push_back(i < 3 ? one(mesh.positions[v * 3 + i]) : one(1.0f));
    }
  }
  return out;
}

void run(App& app) {
  const Mesh mesh = wavy_grid(6);
  const auto halves = convert<std::uint16_t>(mesh, 4, to_half);
  const auto snorms = convert<std::int16_t>(mesh, 4, [](float x) {
    return static_cast<std::int16_t>(std::lround(std::clamp(x, -1.0f, 1.0f) * 32767));
  });
  std::vector<std::uint16_t> small(mesh.indices.begin(), mesh.indices.end());
  std::vector<Geometry> geometries;
  const auto add = [&](VkFormat format, std::uint32_t stride,
                       VkDeviceAddress vertices) -> Geometry& {
    geometries.push_back(app.triangles(mesh));
    auto& data = geometries.back().description.geometry.triangles;
    data.vertexFormat = format;
    data.vertexStride = stride;
    data.vertexData.deviceAddress = vertices;
    return geometries.back();
  };
  const std::vector<VkTransformMatrixKHR> transforms = {
      translation(9, 9, 9),
      {{{0.6f, 0.1f, 0, 0.2f}, {0, 0.5f, 0.2f, 0.3f}, {0.1f, 0, 0.7f, -0.4f}}}};
  auto& half = add(VK_FORMAT_R16G16B16A16_SFLOAT, 8, app.make_buffer(halves).address);
  half.description.geometry.triangles.transformData.deviceAddress =
      app.make_buffer(transforms).address;
  half.range.transformOffset = sizeof(VkTransformMatrixKHR);
  auto& norm = add(VK_FORMAT_R16G16B16A16_SNORM, 8, app.make_buffer(snorms).address);
  norm.description.geometry.triangles.indexType = VK_INDEX_TYPE_UINT16;
  small.insert(small.begin(), {0, 0});
  norm.description.geometry.triangles.indexData.deviceAddress = app.make_buffer(small).address;
  norm.range.primitiveOffset = 4;
  // Flat triangles without indices, the first vertices skipped. They do not overlap: surfaces at
  // exactly the same distance would be told apart by the order of traversal alone.
  std::vector<float> flat;
  for (int i = 0; i < 24; ++i) {
    const auto column = static_cast<float>(i / 3);
    flat.insert(flat.end(),
                {-0.9f + 0.22f * column + (i % 3 == 1 ? 0.15f : 0.0f), i % 3 == 2 ? 0.3f : -0.2f});
  }
  auto& plain = add(VK_FORMAT_R32G32_SFLOAT, 8, app.make_buffer(flat).address);
  plain.description.geometry.triangles.indexType = VK_INDEX_TYPE_NONE_KHR;
  plain.description.geometry.triangles.indexData.deviceAddress = 0;
  plain.range.primitiveCount = 5;
  plain.range.firstVertex = 3;
  const Structure all = app.blas(geometries);
  const VkDescriptorSet set = app.make_set(app.tlas({App::instance(all, translation(0, 0, 0))}));
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"}},
                       {general(0), general(1), hit(2), hit(2), hit(2)}, {1, 3, 0});
  app.run([&](VkCommandBuffer commands) { app.trace(commands, pipeline, set); });
}
const Program program("formats", run);
}  // namespace
