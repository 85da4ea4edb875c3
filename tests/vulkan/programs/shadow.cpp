// Primary rays, then occlusion rays that skip the closest-hit shader.
#include "harness/app.h"

namespace {
using namespace foreign;

void run(App& app) {
  const Structure grid = app.blas({app.triangles(wavy_grid(24))});
  const Structure block = app.blas({app.triangles(cube())});
  const Structure tlas = app.tlas({App::instance(grid, translation(0, 0, -0.5f)),
                                   App::instance(block, translation(0.3f, 0.4f, 0.6f))});
  const VkDescriptorSet set = app.make_set(tlas);
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "shadow.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "sky.rmiss"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "lit.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "shadow.rchit"}},
                       {general(0), general(1), general(2), hit(3)}, {2, 1, 0});
  app.run([&](VkCommandBuffer commands) { app.trace(commands, pipeline, set); });
}
const Program program("shadow", run);
}  // namespace
