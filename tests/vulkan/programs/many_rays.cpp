// One frame of four million rays.
#include "harness/app.h"

namespace {
using namespace foreign;

void run(App& app) {
  const Structure grid = app.blas({app.triangles(wavy_grid(24))});
  const VkDescriptorSet set = app.make_set(app.tlas({App::instance(grid, translation(0, 0, 0))}));
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "many.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"}},
                       {general(0), general(1), hit(2)}, {1, 1, 0});
  app.run([&](VkCommandBuffer commands) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, pipeline.handle);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, app.layout(), 0, 1,
                            &set, 0, nullptr);
    app.vkCmdTraceRaysKHR(commands, &pipeline.raygen, &pipeline.miss, &pipeline.hit,
                          &pipeline.callable, 22 * kWidth, 31 * kHeight, 1);
    App::barrier(commands);
  });
}
const Program program("many_rays", run);
}  // namespace
