// Mirrored, sheared and inactive instances, given as an array and as an array of pointers, with
// masks and facing flags.
#include <limits>

#include "harness/app.h"

namespace {
using namespace foreign;

std::vector<VkAccelerationStructureInstanceKHR> make_list(const Structure& ball,
                                                          const Structure& block) {
  std::vector<VkAccelerationStructureInstanceKHR> list;
  for (int i = 0; i < 14; ++i) {
    const auto n = static_cast<float>(i);
    const float mirror = i % 3 == 0 ? -1.0f : 1.0f;
    const float shear = 0.2f * static_cast<float>(i % 4);
    const VkTransformMatrixKHR matrix = {{{0.5f * mirror, shear, 0.1f, 0.3f * (n - 7) / 2},
                                          {0.05f * n, 0.4f, 0, 0.5f - 0.09f * n},
                                          {0, 0.1f, 0.6f + shear, -0.1f * n}}};
    auto one = App::instance(i % 2 == 0 ? ball : block, matrix, static_cast<std::uint32_t>(i));
    if (i % 5 == 1) {
      one.flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FLIP_FACING_BIT_KHR;
    } else if (i % 5 == 2) {
      one.flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR;
    }
    one.mask = i == 6 ? 0 : 0xff;
    if (i == 9) {
      one.accelerationStructureReference = 0;
    }
    list.push_back(one);
  }
  return list;
}

void run(App& app) {
  Mesh broken = sphere(10);
  // A triangle whose first vertex is NaN is inactive.
  broken.indices[30] = static_cast<std::uint32_t>(broken.positions.size() / 3);
  broken.positions.insert(broken.positions.end(), {std::numeric_limits<float>::quiet_NaN(), 0, 0});
  const Structure ball = app.blas({app.triangles(broken)});
  const Structure block = app.blas({app.triangles(cube())});
  const auto list = make_list(ball, block);
  const Buffer storage = app.make_buffer(list);
  std::vector<VkDeviceAddress> pointers;
  for (std::size_t i = list.size(); i-- > 0;) {
    pointers.push_back(storage.address + i * sizeof(list[0]));
  }
  const Buffer pointer_storage = app.make_buffer(pointers);
  StructureInput top;
  top.type = VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR;
  top.geometries = {app.instances(list)};
  auto& data = top.geometries[0].description.geometry.instances;
  data.arrayOfPointers = VK_TRUE;
  data.data.deviceAddress = pointer_storage.address;
  const Structure by_pointer = app.build_now(top);
  const Structure by_array = app.tlas(list);
  const VkDescriptorSet set = app.make_set(by_pointer, nullptr, &by_array);
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "two.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"}},
                       {general(0), general(1), hit(2)}, {1, 1, 0});
  app.run([&](VkCommandBuffer commands) { app.trace(commands, pipeline, set); });
}
const Program program("instances", run);
}  // namespace
