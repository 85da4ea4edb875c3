// A closest-hit shader that runs one of two callable shaders.
#include "harness/app.h"

namespace {
using namespace foreign;

void run(App& app) {
  const Structure grid = app.blas({app.triangles(wavy_grid(10))});
  const VkDescriptorSet set = app.make_set(app.tlas({App::instance(grid, translation(0, 0, 0))}));
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "call.rchit"},
                        {VK_SHADER_STAGE_CALLABLE_BIT_KHR, "even.rcall"},
                        {VK_SHADER_STAGE_CALLABLE_BIT_KHR, "odd.rcall"}},
                       {general(0), general(1), hit(2), general(3), general(4)}, {1, 1, 2});
  app.run([&](VkCommandBuffer commands) { app.trace(commands, pipeline, set); });
}
const Program program("callable", run);
}  // namespace
