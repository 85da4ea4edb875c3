// Spheres in boxes by an intersection shader, with an any-hit shader that makes holes, beside a
// mesh; in one variant some boxes are inactive.
#include <limits>

#include "harness/app.h"

namespace {
using namespace foreign;

void draw(App& app, bool some_inactive) {
  std::vector<VkAabbPositionsKHR> boxes;
  std::vector<float> balls;
  for (int i = 0; i < 24; ++i) {
    const auto n = static_cast<float>(i);
    const float x = 0.3f * static_cast<float>(i % 6) - 0.8f;
    const float y = 0.4f * static_cast<float>(i / 6) - 0.6f;
    const float z = 0.02f * n;
    const float r = 0.1f + 0.003f * n;
    balls.insert(balls.end(), {x, y, z, r});
    boxes.push_back({x - r, y - r, z - r, x + r, y + r, z + r});
    if (some_inactive && i % 5 == 4) {
      boxes.back().minX = std::numeric_limits<float>::quiet_NaN();
    }
  }
  const Buffer data = app.make_buffer(balls);
  const Structure field = app.blas({app.boxes(boxes)});
  const Structure wall = app.blas({app.triangles(wavy_grid(6))});
  auto second = App::instance(wall, translation(0, 0, -0.5f));
  second.instanceShaderBindingTableRecordOffset = 1;
  const VkDescriptorSet set =
      app.make_set(app.tlas({App::instance(field, translation(0, 0, 0)), second}), &data);
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "ball.rchit"},
                        {VK_SHADER_STAGE_ANY_HIT_BIT_KHR, "ball.rahit"},
                        {VK_SHADER_STAGE_INTERSECTION_BIT_KHR, "ball.rint"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"}},
                       {general(0), general(1), hit(2, 3, 4), hit(5)}, {1, 2, 0});
  app.run([&](VkCommandBuffer commands) { app.trace(commands, pipeline, set); });
}
const Program all_active("procedural", [](App& app) { draw(app, false); });
const Program some_inactive("inactive_boxes", [](App& app) { draw(app, true); });
}  // namespace
