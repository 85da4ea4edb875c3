// Two frames: between them the vertices move, the BLAS is updated in place and the TLAS with it.
// The same command buffer is submitted for both.
#include "harness/app.h"

namespace {
using namespace foreign;

void run(App& app) {
  const Mesh mesh = wavy_grid(14);
  StructureInput bottom;
  bottom.flags |= VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_UPDATE_BIT_KHR;
  bottom.geometries = {app.triangles(mesh)};
  const Buffer vertices = app.make_buffer(mesh.positions);
  bottom.geometries[0].description.geometry.triangles.vertexData.deviceAddress = vertices.address;
  const Structure grid = app.build_now(bottom);
  StructureInput top;
  top.type = VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR;
  top.flags |= VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_UPDATE_BIT_KHR;
  std::vector<VkAccelerationStructureInstanceKHR> list;
  for (int i = 0; i < 5; ++i) {
    list.push_back(App::instance(
        grid, translation(0.3f * static_cast<float>(i - 2), 0, -0.4f * static_cast<float>(i))));
  }
  top.geometries = {app.instances(list)};
  const Structure tlas = app.build_now(top);
  const VkDescriptorSet set = app.make_set(tlas);
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"}},
                       {general(0), general(1), hit(2)}, {1, 1, 0});
  const VkCommandBuffer commands = app.make_commands();
  App::begin(commands, VK_COMMAND_BUFFER_USAGE_SIMULTANEOUS_USE_BIT);
  app.build(commands, bottom, grid, VK_BUILD_ACCELERATION_STRUCTURE_MODE_UPDATE_KHR);
  app.build(commands, top, tlas, VK_BUILD_ACCELERATION_STRUCTURE_MODE_UPDATE_KHR);
  const std::uint32_t constants[2] = {0, 1};  // mix with the picture so far
  vkCmdPushConstants(commands, app.layout(), VK_SHADER_STAGE_ALL, 0, sizeof(constants), constants);
  app.trace(commands, pipeline, set);
  check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
  for (int frame = 0; frame < 2; ++frame) {
    app.submit(commands);
    const auto place = vertices.as<float>();
    for (std::size_t i = 2; i < place.size(); i += 3) {
      place[i] += 0.3f * place[i - 2];
    }
  }
}
const Program program("update", run);
}  // namespace
