// Ray queries with candidates in a compute shader whose group size is a specialization constant:
// an indirect dispatch, and one whose groups do not begin at 0.
#include "harness/query_dispatch.h"

namespace {
using namespace foreign;

void draw_with(App& app, VkPipelineCreateFlags flags,
               const std::function<void(VkCommandBuffer)>& dispatch) {
  const Structure grid = app.blas({app.triangles(wavy_grid(12), 0)});
  const VkDescriptorSet set = app.make_set(app.tlas(
      {App::instance(grid, translation(0, 0, 0)), App::instance(grid, translation(0, 0, -1))}));
  run_query(app, app.stage_info({VK_SHADER_STAGE_COMPUTE_BIT, "query.comp"}), flags, set, dispatch);
}

void indirect(App& app) {
  const Buffer groups =
      app.make_buffer(std::vector<std::uint32_t>{kWidth / kGroupWidth, kHeight / kGroupHeight, 1});
  draw_with(app, 0,
            [&](VkCommandBuffer commands) { vkCmdDispatchIndirect(commands, groups.handle, 0); });
}

// The lower half of the picture.
void with_base(App& app) {
  constexpr std::uint32_t kHalf = kHeight / kGroupHeight / 2;
  draw_with(app, VK_PIPELINE_CREATE_DISPATCH_BASE_BIT, [&](VkCommandBuffer commands) {
    vkCmdDispatchBase(commands, 0, kHalf, 0, kWidth / kGroupWidth, kHalf, 1);
  });
}

const Program by_indirect("query_compute", indirect);
const Program by_base("query_dispatch_base", with_base);
}  // namespace
