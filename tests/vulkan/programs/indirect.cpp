// Both kinds of indirect traces; the sizes are written by the device right before.
#include <cstddef>

#include "harness/app.h"

namespace {
using namespace foreign;

void run(App& app) {
  const Structure grid = app.blas({app.triangles(wavy_grid(10))});
  const VkDescriptorSet set = app.make_set(app.tlas({App::instance(grid, translation(0, 0, 0))}));
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"}},
                       {general(0), general(1), hit(2)}, {1, 1, 0});
  VkTraceRaysIndirectCommand2KHR all{};
  all.raygenShaderRecordAddress = pipeline.raygen.deviceAddress;
  all.raygenShaderRecordSize = pipeline.raygen.size;
  all.missShaderBindingTableAddress = pipeline.miss.deviceAddress;
  all.missShaderBindingTableSize = pipeline.miss.size;
  all.missShaderBindingTableStride = pipeline.miss.stride;
  all.hitShaderBindingTableAddress = pipeline.hit.deviceAddress;
  all.hitShaderBindingTableSize = pipeline.hit.size;
  all.hitShaderBindingTableStride = pipeline.hit.stride;
  const Buffer arguments = app.make_buffer(sizeof(all), &all);
  constexpr VkDeviceSize kSize = offsetof(VkTraceRaysIndirectCommand2KHR, width);
  app.run([&](VkCommandBuffer commands) {
    const std::uint32_t size[3] = {kWidth, kHeight, 1};
    vkCmdUpdateBuffer(commands, arguments.handle, kSize, sizeof(size), size);
    App::barrier(commands);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, pipeline.handle);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, app.layout(), 0, 1,
                            &set, 0, nullptr);
    app.vkCmdTraceRaysIndirectKHR(commands, &pipeline.raygen, &pipeline.miss, &pipeline.hit,
                                  &pipeline.callable, arguments.address + kSize);
    App::barrier(commands);
    const std::uint32_t constants[2] = {0, 1};
    vkCmdPushConstants(commands, app.layout(), VK_SHADER_STAGE_ALL, 0, sizeof(constants),
                       constants);
    app.vkCmdTraceRaysIndirect2KHR(commands, arguments.address);
    App::barrier(commands);
  });
}
const Program program("indirect", run);
}  // namespace
