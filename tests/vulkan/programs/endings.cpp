// Programs that do not end as they should: one dies after a trace, one exits without cleaning up.
#include <csignal>
#include <cstdlib>

#include "harness/app.h"

namespace {
using namespace foreign;

void trace_once(App& app) {
  const Structure grid = app.blas({app.triangles(wavy_grid(4))});
  const VkDescriptorSet set = app.make_set(app.tlas({App::instance(grid, translation(0, 0, 0))}));
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"}},
                       {general(0), general(1), hit(2)}, {1, 1, 0});
  app.run([&](VkCommandBuffer commands) { app.trace(commands, pipeline, set); });
}

void crash(App& app) {
  trace_once(app);
  std::raise(SIGKILL);
}

void leave(App& app) {
  trace_once(app);
  std::exit(0);
}

const Program crashing("crash", crash);
const Program leaving("early_exit", leave);
}  // namespace
