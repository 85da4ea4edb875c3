// vkQueueSubmit2 with several submits and command buffers; and two devices in one process.
#include <array>

#include "harness/app.h"

namespace {
using namespace foreign;

RayPipeline make_pipeline(App& app) {
  return app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
                           {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                           {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"}},
                          {general(0), general(1), hit(2)}, {1, 1, 0});
}

VkDescriptorSet make_scene(App& app, float shift) {
  const Structure grid = app.blas({app.triangles(wavy_grid(10))});
  return app.make_set(app.tlas({App::instance(grid, translation(shift, 0, 0)),
                                App::instance(grid, translation(0.4f, shift, -0.6f))}));
}

void submit2(App& app) {
  const VkDescriptorSet set = make_scene(app, 0);
  const RayPipeline pipeline = make_pipeline(app);
  const VkCommandBuffer commands = app.make_commands();
  App::begin(commands, VK_COMMAND_BUFFER_USAGE_SIMULTANEOUS_USE_BIT);
  const std::uint32_t constants[2] = {0, 1};
  vkCmdPushConstants(commands, app.layout(), VK_SHADER_STAGE_ALL, 0, sizeof(constants), constants);
  app.trace(commands, pipeline, set);
  check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
  VkCommandBufferSubmitInfo one{};
  one.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO;
  one.commandBuffer = commands;
  const std::array twice = {one, one};
  std::array<VkSubmitInfo2, 2> submits{};
  for (VkSubmitInfo2& submit : submits) {
    submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2;
    submit.commandBufferInfoCount = 1;
    submit.pCommandBufferInfos = &one;
  }
  submits[1].commandBufferInfoCount = static_cast<std::uint32_t>(twice.size());
  submits[1].pCommandBufferInfos = twice.data();
  check(vkQueueSubmit2(app.queue(), static_cast<std::uint32_t>(submits.size()), submits.data(),
                       VK_NULL_HANDLE),
        "vkQueueSubmit2");
  check(vkQueueWaitIdle(app.queue()), "vkQueueWaitIdle");
}

void trace_scene(App& app, float shift) {
  const VkDescriptorSet set = make_scene(app, shift);
  const RayPipeline pipeline = make_pipeline(app);
  app.run([&](VkCommandBuffer commands) { app.trace(commands, pipeline, set); });
}

void two_devices(App& app) {
  App other;
  trace_scene(app, 0);
  trace_scene(other, 0.3f);
}

const Program with_submit2("submit2", submit2);
const Program at_once("two_devices", two_devices);
}  // namespace
