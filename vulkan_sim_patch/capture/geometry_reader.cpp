#include "capture/geometry_reader.h"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

namespace a2rt::layer {
namespace {

template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return value;
}

const std::byte* host(VkDeviceAddress address) {
  return reinterpret_cast<const std::byte*>(address);
}

// The driver multiplies by the reciprocal instead of dividing.
float unorm(std::uint32_t value, std::uint32_t most) {
  return static_cast<float>(value) * (1.0f / static_cast<float>(most));
}

float snorm(std::int32_t value, std::int32_t most) {
  return value <= -most ? -1.0f : static_cast<float>(value) * (1.0f / static_cast<float>(most));
}

enum class Component { kFloat32, kFloat16, kSnorm16, kUnorm16, kSnorm8, kUnorm8, kPacked10, kNone };

struct VertexFormat {
  Component component = Component::kNone;
  int count = 0;
};

VertexFormat describe(VkFormat format) {
  switch (format) {
    case VK_FORMAT_R32G32_SFLOAT:
      return {Component::kFloat32, 2};
    case VK_FORMAT_R32G32B32_SFLOAT:
      return {Component::kFloat32, 3};
    case VK_FORMAT_R32G32B32A32_SFLOAT:
      return {Component::kFloat32, 4};
    case VK_FORMAT_R16G16_SFLOAT:
      return {Component::kFloat16, 2};
    case VK_FORMAT_R16G16B16_SFLOAT:
      return {Component::kFloat16, 3};
    case VK_FORMAT_R16G16B16A16_SFLOAT:
      return {Component::kFloat16, 4};
    case VK_FORMAT_R16G16_SNORM:
      return {Component::kSnorm16, 2};
    case VK_FORMAT_R16G16B16A16_SNORM:
      return {Component::kSnorm16, 4};
    case VK_FORMAT_R16G16_UNORM:
      return {Component::kUnorm16, 2};
    case VK_FORMAT_R16G16B16A16_UNORM:
      return {Component::kUnorm16, 4};
    case VK_FORMAT_R8G8_SNORM:
      return {Component::kSnorm8, 2};
    case VK_FORMAT_R8G8B8A8_SNORM:
      return {Component::kSnorm8, 4};
    case VK_FORMAT_R8G8_UNORM:
      return {Component::kUnorm8, 2};
    case VK_FORMAT_R8G8B8A8_UNORM:
      return {Component::kUnorm8, 4};
    case VK_FORMAT_A2B10G10R10_UNORM_PACK32:
      return {Component::kPacked10, 4};
    default:
      return {};
  }
}

float component(const std::byte* vertex, Component kind, int i) {
  switch (kind) {
    case Component::kFloat32:
      return load<float>(vertex + 4 * i);
    case Component::kFloat16:
      return half_to_float(load<std::uint16_t>(vertex + 2 * i));
    case Component::kSnorm16:
      return snorm(load<std::int16_t>(vertex + 2 * i), 32767);
    case Component::kUnorm16:
      return unorm(load<std::uint16_t>(vertex + 2 * i), 65535);
    case Component::kSnorm8:
      return snorm(load<std::int8_t>(vertex + i), 127);
    case Component::kUnorm8:
      return unorm(load<std::uint8_t>(vertex + i), 255);
    case Component::kPacked10: {
      const auto word = load<std::uint32_t>(vertex);
      return i == 3 ? unorm(word >> 30, 3) : unorm((word >> (10 * i)) & 1023u, 1023);
    }
    case Component::kNone:
      break;
  }
  return 0;
}

// lavapipe multiplies a fourth component with the translation instead of leaving it out.
std::array<float, 4> load_vertex(const std::byte* vertex, VertexFormat format) {
  std::array<float, 4> out = {0, 0, 0, 1};
  for (int i = 0; i < format.count; ++i) {
    out[static_cast<std::size_t>(i)] = component(vertex, format.component, i);
  }
  return out;
}

}  // namespace

float half_to_float(std::uint16_t half) {
  const int exponent = (half >> 10) & 31;
  const int mantissa = half & 1023;
  float value = 0;
  if (exponent == 31) {
    value = mantissa == 0 ? std::numeric_limits<float>::infinity()
                          : std::numeric_limits<float>::quiet_NaN();
  } else if (exponent == 0) {
    value = std::ldexp(static_cast<float>(mantissa), -24);
  } else {
    value = std::ldexp(static_cast<float>(1024 + mantissa), exponent - 25);
  }
  return (half & 0x8000) != 0 ? -value : value;
}

TriangleReader::TriangleReader(const VkAccelerationStructureGeometryTrianglesDataKHR& data,
                               const VkAccelerationStructureBuildRangeInfoKHR& range,
                               FirstVertex first_vertex)
    : data_(data),
      vertices_(host(data.vertexData.deviceAddress)),
      indices_(host(data.indexData.deviceAddress)),
      index_offset_(range.firstVertex),
      transform_({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}) {
  if (first_vertex == FirstVertex::kTwice) {
    index_offset_ *= 2;
  }
  if (data.indexType == VK_INDEX_TYPE_NONE_KHR) {
    vertices_ += range.primitiveOffset;
  } else {
    indices_ += range.primitiveOffset;
  }
  if (data.transformData.deviceAddress != 0) {
    std::memcpy(transform_.data(), host(data.transformData.deviceAddress) + range.transformOffset,
                sizeof(transform_));
  }
}

bool TriangleReader::supported() const {
  const bool index_type =
      data_.indexType == VK_INDEX_TYPE_NONE_KHR || data_.indexType == VK_INDEX_TYPE_UINT8_EXT ||
      data_.indexType == VK_INDEX_TYPE_UINT16 || data_.indexType == VK_INDEX_TYPE_UINT32;
  return index_type && describe(data_.vertexFormat).count != 0;
}

std::uint64_t TriangleReader::index(std::uint64_t position) const {
  switch (data_.indexType) {
    case VK_INDEX_TYPE_UINT8_EXT:
      return load<std::uint8_t>(indices_ + position);
    case VK_INDEX_TYPE_UINT16:
      return load<std::uint16_t>(indices_ + 2 * position);
    case VK_INDEX_TYPE_UINT32:
      return load<std::uint32_t>(indices_ + 4 * position);
    default:
      return position;
  }
}

std::array<float, 9> TriangleReader::read(std::uint32_t primitive) const {
  const VertexFormat format = describe(data_.vertexFormat);
  std::array<float, 9> out{};
  for (std::size_t v = 0; v < 3; ++v) {
    const std::uint64_t at = index_offset_ + index(std::uint64_t{primitive} * 3 + v);
    const auto c = load_vertex(vertices_ + at * data_.vertexStride, format);
    for (std::size_t row = 0; row < 3; ++row) {
      // The sum begins with zero, as the driver's does: -0 becomes +0.
      float sum = 0;
      for (std::size_t column = 0; column < 4; ++column) {
        sum += transform_[row * 4 + column] * c[column];
      }
      out[v * 3 + row] = sum;
    }
  }
  return out;
}

std::array<float, 6> read_aabb(const VkAccelerationStructureGeometryAabbsDataKHR& data,
                               const VkAccelerationStructureBuildRangeInfoKHR& range,
                               std::uint32_t primitive) {
  std::array<float, 6> out;
  std::memcpy(out.data(),
              host(data.data.deviceAddress) + range.primitiveOffset + primitive * data.stride,
              sizeof(out));
  return out;
}

VkAccelerationStructureInstanceKHR read_instance(
    const VkAccelerationStructureGeometryInstancesDataKHR& data,
    const VkAccelerationStructureBuildRangeInfoKHR& range, std::uint32_t instance) {
  const std::byte* base = host(data.data.deviceAddress) + range.primitiveOffset;
  if (data.arrayOfPointers == VK_TRUE) {
    const auto address = load<VkDeviceAddress>(base + std::uint64_t{instance} * 8);
    return load<VkAccelerationStructureInstanceKHR>(host(address));
  }
  return load<VkAccelerationStructureInstanceKHR>(
      base + std::uint64_t{instance} * sizeof(VkAccelerationStructureInstanceKHR));
}

}  // namespace a2rt::layer
