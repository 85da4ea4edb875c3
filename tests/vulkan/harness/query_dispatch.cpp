#include "harness/query_dispatch.h"

namespace foreign {

void run_query(App& app, VkPipelineShaderStageCreateInfo stage, VkPipelineCreateFlags flags,
               VkDescriptorSet set, const std::function<void(VkCommandBuffer)>& dispatch) {
  const VkSpecializationMapEntry entry{0, 0, sizeof(kGroupWidth)};
  const VkSpecializationInfo constants{1, &entry, sizeof(kGroupWidth), &kGroupWidth};
  stage.pSpecializationInfo = &constants;
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.flags = flags;
  info.stage = stage;
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

}  // namespace foreign
