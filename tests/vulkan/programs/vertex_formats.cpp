// One geometry for each vertex format that the driver takes, each in a cell of its own; index types
// take turns.
#include <algorithm>
#include <cmath>
#include <optional>

#include "harness/app.h"

namespace {
using namespace foreign;

enum class Coding { kFloat, kHalf, kSnorm16, kUnorm16, kSnorm8, kUnorm8, kPacked };

struct Format {
  VkFormat format;
  std::uint32_t components;
  Coding coding;
};

constexpr Format kFormats[] = {
    {VK_FORMAT_R32G32_SFLOAT, 2, Coding::kFloat},
    {VK_FORMAT_R32G32B32_SFLOAT, 3, Coding::kFloat},
    {VK_FORMAT_R32G32B32A32_SFLOAT, 4, Coding::kFloat},
    {VK_FORMAT_R16G16_SFLOAT, 2, Coding::kHalf},
    {VK_FORMAT_R16G16B16_SFLOAT, 3, Coding::kHalf},
    {VK_FORMAT_R16G16B16A16_SFLOAT, 4, Coding::kHalf},
    {VK_FORMAT_R16G16_SNORM, 2, Coding::kSnorm16},
    {VK_FORMAT_R16G16B16_SNORM, 3, Coding::kSnorm16},
    {VK_FORMAT_R16G16B16A16_SNORM, 4, Coding::kSnorm16},
    {VK_FORMAT_R16G16_UNORM, 2, Coding::kUnorm16},
    {VK_FORMAT_R16G16B16_UNORM, 3, Coding::kUnorm16},
    {VK_FORMAT_R16G16B16A16_UNORM, 4, Coding::kUnorm16},
    {VK_FORMAT_R8G8_SNORM, 2, Coding::kSnorm8},
    {VK_FORMAT_R8G8B8_SNORM, 3, Coding::kSnorm8},
    {VK_FORMAT_R8G8B8A8_SNORM, 4, Coding::kSnorm8},
    {VK_FORMAT_R8G8_UNORM, 2, Coding::kUnorm8},
    {VK_FORMAT_R8G8B8_UNORM, 3, Coding::kUnorm8},
    {VK_FORMAT_R8G8B8A8_UNORM, 4, Coding::kUnorm8},
    {VK_FORMAT_A2B10G10R10_UNORM_PACK32, 3, Coding::kPacked},
};

class Bytes {
 public:
  template <class T>
  void put(T value) {
    const auto* const first = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), first, first + sizeof(value));
  }
  const std::vector<std::uint8_t>& all() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

std::uint16_t to_half(float value) {
  // Enough for numbers of this program: normal halves, and zero for what is smaller.
  if (std::fabs(value) < 1e-4f) {
    return 0;
  }
  int exponent = 0;
  const float mantissa = std::frexp(std::fabs(value), &exponent);
  const auto bits = std::lround((mantissa * 2 - 1) * 1024);
  return static_cast<std::uint16_t>((value < 0 ? 0x8000 : 0) + ((exponent + 14) << 10) + bits);
}

long scaled(float value, long most) { return std::lround(value * static_cast<float>(most)); }
// From -1..1 to 0..1.
float raised(float value) { return std::clamp(value * 0.5f + 0.5f, 0.0f, 1.0f); }

void encode(Coding coding, float x, Bytes& out) {
  switch (coding) {
    case Coding::kFloat:
      return out.put(x);
    case Coding::kHalf:
      return out.put(to_half(x));
    case Coding::kSnorm16:
      return out.put(static_cast<std::int16_t>(scaled(x, 32767)));
    case Coding::kUnorm16:
      return out.put(static_cast<std::uint16_t>(scaled(raised(x), 65535)));
    case Coding::kSnorm8:
      return out.put(static_cast<std::int8_t>(scaled(x, 127)));
    case Coding::kUnorm8:
      return out.put(static_cast<std::uint8_t>(scaled(raised(x), 255)));
    case Coding::kPacked:
      break;
  }
}

std::vector<std::uint8_t> encode(const Format& format, const Mesh& mesh) {
  Bytes out;
  for (std::size_t v = 0; v < mesh.positions.size(); v += 3) {
    const float* const at = &mesh.positions[v];
    if (format.coding == Coding::kPacked) {
      std::uint32_t word = 0;
      for (std::uint32_t i = 0; i < 3; ++i) {
        word |= static_cast<std::uint32_t>(scaled(raised(at[i]), 1023)) << (10 * i);
      }
      out.put(word);
      continue;
    }
    for (std::uint32_t i = 0; i < format.components; ++i) {
      encode(format.coding, i < 3 ? at[i] : 1.0f, out);
    }
  }
  return out.all();
}

std::optional<Format> known(VkFormat format) {
  for (const Format& one : kFormats) {
    if (one.format == format) {
      return one;
    }
  }
  return std::nullopt;
}

std::vector<Format> formats_of_driver(const App& app) {
  std::vector<Format> found;
  for (std::uint32_t i = 1; i <= VK_FORMAT_ASTC_12x12_SRGB_BLOCK; ++i) {
    const auto format = static_cast<VkFormat>(i);
    VkFormatProperties properties{};
    vkGetPhysicalDeviceFormatProperties(app.physical(), format, &properties);
    if ((properties.bufferFeatures &
         VK_FORMAT_FEATURE_ACCELERATION_STRUCTURE_VERTEX_BUFFER_BIT_KHR) == 0) {
      continue;
    }
    const auto listed = known(format);
    if (!listed) {
      throw std::runtime_error("the driver takes vertices of format " + std::to_string(i) +
                               ", which this program cannot write");
    }
    found.push_back(*listed);
  }
  return found;
}

VkTransformMatrixKHR cell(std::size_t number) {
  const float x = -0.9f + 0.6f * static_cast<float>(number % 4);
  const float y = -0.8f + 0.4f * static_cast<float>(number / 4);
  return {{{0.25f, 0, 0, x}, {0, 0.18f, 0, y}, {0, 0, 0.2f, 0}}};
}

void run(App& app) {
  const Mesh mesh = wavy_grid(5);
  const std::vector<std::uint16_t> small(mesh.indices.begin(), mesh.indices.end());
  const Buffer small_indices = app.make_buffer(small);
  std::vector<Geometry> geometries;
  for (const Format& format : formats_of_driver(app)) {
    const std::vector<std::uint8_t> vertices = encode(format, mesh);
    const std::vector<VkTransformMatrixKHR> transform = {cell(geometries.size())};
    Geometry geometry = app.triangles(mesh);
    auto& data = geometry.description.geometry.triangles;
    data.vertexFormat = format.format;
    data.vertexStride = vertices.size() / (mesh.positions.size() / 3);
    data.vertexData.deviceAddress = app.make_buffer(vertices).address;
    data.transformData.deviceAddress = app.make_buffer(transform).address;
    if (geometries.size() % 2 == 1) {
      data.indexType = VK_INDEX_TYPE_UINT16;
      data.indexData.deviceAddress = small_indices.address;
    }
    geometries.push_back(geometry);
  }
  const Structure all = app.blas(geometries);
  const VkDescriptorSet set = app.make_set(app.tlas({App::instance(all, translation(0, 0, 0))}));
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"}},
                       {general(0), general(1), hit(2)}, {1, 1, 0});
  app.run([&](VkCommandBuffer commands) { app.trace(commands, pipeline, set); });
}
const Program program("vertex_formats", run);
}  // namespace
