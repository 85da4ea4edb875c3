// Several ray queries alive at once in one invocation of a compute shader.
#include "harness/app.h"

namespace {
using namespace foreign;

void alive(App& app) {
  const Structure grid = app.blas({app.triangles(wavy_grid(12))});
  const VkDescriptorSet set = app.make_set(app.tlas(
      {App::instance(grid, translation(0, 0, 0)), App::instance(grid, translation(0, 0, -1))}));
  const VkPipeline pipeline = app.compute_pipeline("alive.comp");
  app.run([&](VkCommandBuffer commands) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, app.layout(), 0, 1, &set, 0,
                            nullptr);
    vkCmdDispatch(commands, kWidth / 8, kHeight / 4, 1);
    App::barrier(commands);
  });
}

const Program by_alive("query_alive", alive);
}  // namespace
