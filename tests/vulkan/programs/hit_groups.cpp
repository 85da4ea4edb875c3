// Several geometries and instances that choose hit groups by instance and ray offsets; an unused
// closest-hit shader in one of them; shader-record data.
#include "harness/app.h"

namespace {
using namespace foreign;

void run(App& app) {
  const Structure two = app.blas({app.triangles(wavy_grid(8)), app.triangles(cube())});
  const Structure ball = app.blas({app.triangles(sphere(12))});
  auto first = App::instance(two, translation(-0.4f, 0, 0), 1);
  auto other = App::instance(ball, translation(0.7f, 0.2f, 0.3f), 2);
  other.instanceShaderBindingTableRecordOffset = 2;
  auto bare = App::instance(ball, translation(0.6f, -0.5f, 0.4f), 3);
  bare.instanceShaderBindingTableRecordOffset = 3;
  const VkDescriptorSet set = app.make_set(app.tlas({first, other, bare}));
  const RayPipeline pipeline = app.ray_pipeline(
      {{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
       {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
       {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"},
       {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "record.rchit"}},
      {general(0), general(1), hit(2), hit(3), hit(3), hit(2), hit(VK_SHADER_UNUSED_KHR), hit(3)},
      {1, 6, 0});
  app.run([&](VkCommandBuffer commands) {
    const std::uint32_t constants[2] = {1, 0};  // ray offset 1
    vkCmdPushConstants(commands, app.layout(), VK_SHADER_STAGE_ALL, 0, sizeof(constants),
                       constants);
    app.trace(commands, pipeline, set);
  });
}
const Program program("hit_groups", run);
}  // namespace
