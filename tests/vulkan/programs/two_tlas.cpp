// One shader that traces two structures; they are bound by a descriptor copy and swapped by a
// second set, and the frame is traced twice in one submit.
#include <array>

#include "harness/app.h"

namespace {
using namespace foreign;

void run(App& app) {
  const Structure grid = app.blas({app.triangles(wavy_grid(10))});
  const Structure ball = app.blas({app.triangles(sphere(16))});
  const Structure first = app.tlas({App::instance(grid, translation(0, 0, 0))});
  const Structure second = app.tlas({App::instance(ball, translation(0.2f, 0, 0.5f)),
                                     App::instance(ball, translation(-0.6f, 0.3f, 0.2f))});
  const VkDescriptorSet source = app.make_set(first, nullptr, &second);
  const VkDescriptorSet set = app.make_set(second);
  std::array<VkCopyDescriptorSet, 2> copies{};
  for (std::uint32_t i = 0; i < copies.size(); ++i) {
    copies[i] = {
        VK_STRUCTURE_TYPE_COPY_DESCRIPTOR_SET, nullptr, source, 3 * i, 0, set, 3 * i, 0, 1};
  }
  vkUpdateDescriptorSets(app.device(), 0, nullptr, static_cast<std::uint32_t>(copies.size()),
                         copies.data());
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "two.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"}},
                       {general(0), general(1), hit(2)}, {1, 1, 0});
  app.run([&](VkCommandBuffer commands) {
    app.trace(commands, pipeline, set);
    app.trace(commands, pipeline, set);
  });
}
const Program program("two_tlas", run);
}  // namespace
