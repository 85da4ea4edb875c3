// The build and the trace stand in secondary command buffers, one of them executed twice.
#include "harness/app.h"

namespace {
using namespace foreign;

void run(App& app) {
  const Structure grid = app.blas({app.triangles(wavy_grid(10))});
  StructureInput top;
  top.type = VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR;
  top.geometries = {app.instances({App::instance(grid, translation(0, 0, 0)),
                                   App::instance(grid, translation(0.5f, 0.3f, -0.5f)),
                                   App::instance(grid, translation(-0.5f, 0.3f, -0.9f))})};
  const Structure tlas = app.make_structure(top);
  const VkDescriptorSet set = app.make_set(tlas);
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"}},
                       {general(0), general(1), hit(2)}, {1, 1, 0});
  const VkCommandBuffer builds = app.make_commands(VK_COMMAND_BUFFER_LEVEL_SECONDARY);
  App::begin(builds);
  app.build(builds, top, tlas);
  check(vkEndCommandBuffer(builds), "vkEndCommandBuffer");
  const VkCommandBuffer traces = app.make_commands(VK_COMMAND_BUFFER_LEVEL_SECONDARY);
  App::begin(traces, VK_COMMAND_BUFFER_USAGE_SIMULTANEOUS_USE_BIT);
  const std::uint32_t constants[2] = {0, 1};
  vkCmdPushConstants(traces, app.layout(), VK_SHADER_STAGE_ALL, 0, sizeof(constants), constants);
  app.trace(traces, pipeline, set);
  check(vkEndCommandBuffer(traces), "vkEndCommandBuffer");
  app.run([&](VkCommandBuffer commands) {
    vkCmdExecuteCommands(commands, 1, &builds);
    App::barrier(commands);
    vkCmdExecuteCommands(commands, 1, &traces);
    App::barrier(commands);
    vkCmdExecuteCommands(commands, 1, &traces);
    App::barrier(commands);
  });
}
const Program program("secondary", run);
}  // namespace
