// A BLAS is compacted and a clone of the copy is traced.
#include "harness/app.h"

namespace {
using namespace foreign;

void run(App& app) {
  StructureInput input;
  input.flags |= VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_COMPACTION_BIT_KHR;
  input.geometries = {app.triangles(wavy_grid(14))};
  const Structure grid = app.build_now(input);
  VkQueryPoolCreateInfo create{};
  create.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
  create.queryType = VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR;
  create.queryCount = 1;
  VkQueryPool query = VK_NULL_HANDLE;
  check(vkCreateQueryPool(app.device(), &create, nullptr, &query), "vkCreateQueryPool");
  app.run([&](VkCommandBuffer commands) {
    vkCmdResetQueryPool(commands, query, 0, 1);
    app.vkCmdWriteAccelerationStructuresPropertiesKHR(commands, 1, &grid.handle, create.queryType,
                                                      query, 0);
  });
  std::uint64_t size = 0;
  check(vkGetQueryPoolResults(app.device(), query, 0, 1, sizeof(size), &size, sizeof(size),
                              VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "vkGetQueryPoolResults");
  const Structure small = app.make_structure(input.type, size);
  const Structure clone = app.make_structure(input.type, size);
  app.run([&](VkCommandBuffer commands) {
    VkCopyAccelerationStructureInfoKHR copy{};
    copy.sType = VK_STRUCTURE_TYPE_COPY_ACCELERATION_STRUCTURE_INFO_KHR;
    copy.src = grid.handle;
    copy.dst = small.handle;
    copy.mode = VK_COPY_ACCELERATION_STRUCTURE_MODE_COMPACT_KHR;
    app.vkCmdCopyAccelerationStructureKHR(commands, &copy);
    App::barrier(commands);
    copy.src = small.handle;
    copy.dst = clone.handle;
    copy.mode = VK_COPY_ACCELERATION_STRUCTURE_MODE_CLONE_KHR;
    app.vkCmdCopyAccelerationStructureKHR(commands, &copy);
    App::barrier(commands);
  });
  const VkDescriptorSet set = app.make_set(app.tlas(
      {App::instance(clone, translation(0, 0, 0)), App::instance(small, translation(1, 0, -1))}));
  const RayPipeline pipeline =
      app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
                        {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"}},
                       {general(0), general(1), hit(2)}, {1, 1, 0});
  app.run([&](VkCommandBuffer commands) { app.trace(commands, pipeline, set); });
  vkDestroyQueryPool(app.device(), query, nullptr);
}
const Program program("compaction", run);
}  // namespace
