// An any-hit shader that adds to the payload and ends rays: its result depends on the order in
// which the driver finds candidates.
#include "harness/app.h"

namespace {
using namespace foreign;

void run(App& app) {
  const Structure leaf = app.blas({app.triangles(wavy_grid(12), 0)});
  std::vector<VkAccelerationStructureInstanceKHR> list;
  for (int i = 0; i < 4; ++i) {
    list.push_back(App::instance(leaf, translation(0, 0, -0.3f * static_cast<float>(i))));
  }
  const VkDescriptorSet set = app.make_set(app.tlas(list));
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"},
                        {VK_SHADER_STAGE_ANY_HIT_BIT_KHR, "count.rahit"}},
                       {general(0), general(1), hit(2, 3)}, {1, 1, 0});
  app.run([&](VkCommandBuffer commands) { app.trace(commands, pipeline, set); });
}
const Program program("any_hit_order", run);
}  // namespace
