// Ray queries with candidates in a compute shader whose group size is a specialization constant:
// an indirect dispatch, and one whose groups do not begin at 0.
#include "harness/app.h"

namespace {
using namespace foreign;

constexpr std::uint32_t kGroupWidth = 8;
constexpr std::uint32_t kGroupHeight = 4;

void draw_with(App& app, VkPipelineCreateFlags flags,
               const std::function<void(VkCommandBuffer)>& dispatch) {
  const Structure grid = app.blas({app.triangles(wavy_grid(12), 0)});
  const VkDescriptorSet set = app.make_set(app.tlas(
      {App::instance(grid, translation(0, 0, 0)), App::instance(grid, translation(0, 0, -1))}));
  const VkSpecializationMapEntry entry{0, 0, sizeof(kGroupWidth)};
  const VkSpecializationInfo constants{1, &entry, sizeof(kGroupWidth), &kGroupWidth};
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.flags = flags;
  info.stage = app.stage_info({VK_SHADER_STAGE_COMPUTE_BIT, "query.comp"});
  info.stage.pSpecializationInfo = &constants;
  info.layout = app.layout();
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateComputePipelines(app.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
        "vkCreateComputePipelines");
  app.run([&](VkCommandBuffer commands) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, app.layout(), 0, 1, &set, 0,
                            nullptr);
    dispatch(commands);
    App::barrier(commands);
  });
  vkDestroyPipeline(app.device(), pipeline, nullptr);
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
