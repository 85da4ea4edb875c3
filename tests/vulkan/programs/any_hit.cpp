// Alpha-tested geometry: the any-hit shader lets every second checker of a leaf pass.
#include "harness/app.h"

namespace {
using namespace foreign;

void run(App& app) {
  const Structure leaf = app.blas({app.triangles(wavy_grid(12), 0)});
  const Structure floor = app.blas({app.triangles(cube())});
  std::vector<VkAccelerationStructureInstanceKHR> list;
  for (int i = 0; i < 3; ++i) {
    const auto shift = 0.3f * static_cast<float>(i);
    list.push_back(App::instance(leaf, translation(shift - 0.3f, 0.1f * shift, -shift), 3));
  }
  list.push_back(App::instance(floor, translation(0.4f, -0.6f, 0.2f), 9));
  const VkDescriptorSet set = app.make_set(app.tlas(list));
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"},
                        {VK_SHADER_STAGE_ANY_HIT_BIT_KHR, "alpha.rahit"}},
                       {general(0), general(1), hit(2, 3)}, {1, 1, 0});
  app.run([&](VkCommandBuffer commands) { app.trace(commands, pipeline, set); });
}
const Program program("any_hit", run);
}  // namespace
