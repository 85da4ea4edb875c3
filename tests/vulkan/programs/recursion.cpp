// Rays from closest-hit shaders, three levels deep, with a payload of each level.
#include "harness/app.h"

namespace {
using namespace foreign;

void run(App& app) {
  const Structure grid = app.blas({app.triangles(wavy_grid(16))});
  const Structure block = app.blas({app.triangles(cube())});
  const VkDescriptorSet set =
      app.make_set(app.tlas({App::instance(grid, translation(0, 0, -0.5f)),
                             App::instance(block, translation(0.3f, 0.8f, 1.2f)),
                             App::instance(block, translation(-0.8f, -0.2f, 0.4f))}));
  const RayPipeline pipeline = app.ray_pipeline(
      {{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
       {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
       {VK_SHADER_STAGE_MISS_BIT_KHR, "nested.rmiss"},
       {VK_SHADER_STAGE_MISS_BIT_KHR, "last.rmiss"},
       {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "recursive.rchit"},
       {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "nested.rchit"},
       {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "last.rchit"}},
      {general(0), general(1), general(2), general(3), hit(4), hit(5), hit(6)}, {3, 3, 0}, 3);
  app.run([&](VkCommandBuffer commands) { app.trace(commands, pipeline, set); });
}
const Program program("recursion", run);
}  // namespace
