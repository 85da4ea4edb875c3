// Programs that do not end as they should: one dies after a trace, one exits without cleaning up,
// one may write no more than 64 KiB into a file, as on a full disk.
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>

#include "harness/app.h"

namespace {
using namespace foreign;

// `before` runs when everything is ready to be traced.
void trace_once(App& app, const std::function<void()>& before = [] {}) {
  const Structure grid = app.blas({app.triangles(wavy_grid(4))});
  const VkDescriptorSet set = app.make_set(app.tlas({App::instance(grid, translation(0, 0, 0))}));
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"}},
                       {general(0), general(1), hit(2)}, {1, 1, 0});
  before();
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

void full_disk(App& app) {
  // The picture fits; a capture does not. Without the signal, writes fail as on a full disk. The
  // driver's own memory is a file as well, so the limit comes after all allocations.
  trace_once(app, [] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit most{64 << 10, 64 << 10};
    check(::setrlimit(RLIMIT_FSIZE, &most) == 0 ? VK_SUCCESS : VK_ERROR_UNKNOWN, "setrlimit");
  });
}

const Program without_space("full_disk", full_disk);
const Program crashing("crash", crash);
const Program leaving("early_exit", leave);
}  // namespace
