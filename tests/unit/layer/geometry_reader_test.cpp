#include "capture/geometry_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

namespace a2rt::layer {
namespace {

template <class T>
VkDeviceAddress address_of(const std::vector<T>& data) {
  return reinterpret_cast<VkDeviceAddress>(data.data());
}

struct Input {
  VkAccelerationStructureGeometryTrianglesDataKHR data{};
  VkAccelerationStructureBuildRangeInfoKHR range{};
  Input(VkFormat format, std::uint32_t stride, VkDeviceAddress vertices) {
    data.vertexFormat = format;
    data.vertexStride = stride;
    data.vertexData.deviceAddress = vertices;
    data.indexType = VK_INDEX_TYPE_NONE_KHR;
  }
  std::array<float, 9> read(FirstVertex first = FirstVertex::kOnce) const {
    const TriangleReader reader(data, range, first);
    EXPECT_TRUE(reader.supported());
    return reader.read(0);
  }
};

TEST(HalfToFloat, is_exact_for_all_finite_halves_of_either_sign) {
  for (std::uint32_t bits = 0; bits < 0x7c00; ++bits) {
    const double expected = bits < 1024 ? std::ldexp(bits, -24)
                                        : std::ldexp(1024 + (bits & 1023), int(bits >> 10) - 25);
    ASSERT_EQ(half_to_float(static_cast<std::uint16_t>(bits)), expected);
    ASSERT_EQ(half_to_float(static_cast<std::uint16_t>(bits | 0x8000)), -expected);
  }
  EXPECT_TRUE(std::isinf(half_to_float(0x7c00)));
  EXPECT_TRUE(std::isnan(half_to_float(0x7e01)));
}

TEST(TriangleReader, index_types_choose_the_same_vertices) {
  const std::vector<float> vertices = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  const std::vector<std::uint8_t> bytes = {3, 1, 2};
  const std::vector<std::uint16_t> shorts = {3, 1, 2};
  const std::vector<std::uint32_t> words = {3, 1, 2};
  const std::array<float, 9> expected = {9, 10, 11, 3, 4, 5, 6, 7, 8};
  Input input(VK_FORMAT_R32G32B32_SFLOAT, 12, address_of(vertices));
  const std::pair<VkIndexType, VkDeviceAddress> kinds[] = {
      {VK_INDEX_TYPE_UINT8_EXT, address_of(bytes)},
      {VK_INDEX_TYPE_UINT16, address_of(shorts)},
      {VK_INDEX_TYPE_UINT32, address_of(words)}};
  for (const auto& [type, address] : kinds) {
    input.data.indexType = type;
    input.data.indexData.deviceAddress = address;
    EXPECT_EQ(input.read(), expected) << type;
  }
}

TEST(TriangleReader, first_vertex_counts_once_by_the_book_and_twice_as_the_driver_does) {
  std::vector<float> vertices(27);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    vertices[i] = static_cast<float>(i);
  }
  Input input(VK_FORMAT_R32G32B32_SFLOAT, 12, address_of(vertices));
  input.range.firstVertex = 2;
  EXPECT_EQ(input.read()[0], 6);
  EXPECT_EQ(input.read(FirstVertex::kTwice)[0], 12);
}

TEST(TriangleReader, normalized_and_packed_formats_reach_their_ends) {
  const std::vector<std::int16_t> snorm = {32767, -32767, -32768, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  Input a(VK_FORMAT_R16G16B16A16_SNORM, 8, address_of(snorm));
  EXPECT_EQ(a.read()[0], 1);
  EXPECT_EQ(a.read()[1], -1);
  EXPECT_EQ(a.read()[2], -1);
  const std::vector<std::uint32_t> packed(3, 0x3ffu << 10 | 3u << 30);
  Input b(VK_FORMAT_A2B10G10R10_UNORM_PACK32, 4, address_of(packed));
  EXPECT_EQ(b.read()[0], 0);
  EXPECT_EQ(b.read()[1], 1);
  const std::vector<float> flat = {5, 6, 7, 8, 9, 10};
  Input c(VK_FORMAT_R32G32_SFLOAT, 8, address_of(flat));
  EXPECT_EQ(c.read(), (std::array<float, 9>{5, 6, 0, 7, 8, 0, 9, 10, 0}));
  c.data.vertexFormat = VK_FORMAT_R64G64B64_SFLOAT;
  EXPECT_FALSE(TriangleReader(c.data, c.range, FirstVertex::kOnce).supported());
}

TEST(TriangleReader, transforms_rows_by_columns) {
  const std::vector<float> vertices = {1, 2, 3, 0, 0, 0, 0, 0, 0};
  const std::vector<float> matrix = {1, 0, 0, 10, 0, 2, 0, 20, 0, 0, 3, 30};
  Input input(VK_FORMAT_R32G32B32_SFLOAT, 12, address_of(vertices));
  input.data.transformData.deviceAddress = address_of(matrix);
  EXPECT_EQ(input.read(), (std::array<float, 9>{11, 24, 39, 10, 20, 30, 10, 20, 30}));
}

}  // namespace
}  // namespace a2rt::layer
