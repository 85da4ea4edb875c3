// A ray query with candidates in a compute shader whose group size is a specialization constant;
// the dispatch is indirect.
#include "harness/app.h"

namespace {
using namespace foreign;

void run(App& app) {
  const Structure grid = app.blas({app.triangles(wavy_grid(12), 0)});
  const VkDescriptorSet set = app.make_set(app.tlas(
      {App::instance(grid, translation(0, 0, 0)), App::instance(grid, translation(0, 0, -1))}));
  const std::uint32_t width = 8;
  const VkSpecializationMapEntry entry{0, 0, sizeof(width)};
  const VkSpecializationInfo constants{1, &entry, sizeof(width), &width};
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.stage = app.stage_info({VK_SHADER_STAGE_COMPUTE_BIT, "query.comp"});
  info.stage.pSpecializationInfo = &constants;
  info.layout = app.layout();
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateComputePipelines(app.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
        "vkCreateComputePipelines");
  const Buffer groups = app.make_buffer(std::vector<std::uint32_t>{kWidth / width, kHeight / 4, 1});
  app.run([&](VkCommandBuffer commands) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, app.layout(), 0, 1, &set, 0,
                            nullptr);
    vkCmdDispatchIndirect(commands, groups.handle, 0);
    App::barrier(commands);
  });
  vkDestroyPipeline(app.device(), pipeline, nullptr);
}
const Program program("query_compute", run);
}  // namespace
