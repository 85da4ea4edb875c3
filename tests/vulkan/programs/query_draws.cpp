// Ray queries in fragment shaders, once by each way to draw: every way has a pass of its own.
#include <array>

#include "harness/canvas.h"

namespace {
using namespace foreign;

const std::vector<Stage> kVertexStages = {{VK_SHADER_STAGE_VERTEX_BIT, "full.vert"},
                                          {VK_SHADER_STAGE_FRAGMENT_BIT, "query.frag"}};
const std::vector<Stage> kMeshStages = {{VK_SHADER_STAGE_MESH_BIT_EXT, "full.mesh"},
                                        {VK_SHADER_STAGE_FRAGMENT_BIT, "query.frag"}};
const std::vector<Stage> kFeedbackStages = {{VK_SHADER_STAGE_VERTEX_BIT, "feedback.vert"},
                                            {VK_SHADER_STAGE_FRAGMENT_BIT, "query.frag"}};
constexpr std::uint32_t kVertexBytes = 16;  // what feedback.vert writes a vertex

using Draw = std::function<void(VkCommandBuffer)>;

VkDescriptorSet make_scene(App& app) {
  const Structure grid = app.blas({app.triangles(wavy_grid(12), 0)});
  return app.make_set(app.tlas(
      {App::instance(grid, translation(0, 0, 0)), App::instance(grid, translation(0, 0, -1))}));
}

void pass(Canvas& canvas, VkCommandBuffer commands, VkDescriptorSet set, const Draw& draw) {
  canvas.begin(commands);
  canvas.bind(commands, set);
  draw(commands);
  canvas.end(commands);
}

template <class Function>
Function load(App& app, const char* name) {
  const auto function = reinterpret_cast<Function>(vkGetDeviceProcAddr(app.device(), name));
  if (function == nullptr) {
    throw std::runtime_error(std::string("the driver has no ") + name);
  }
  return function;
}

void indexed_and_indirect(App& app) {
  const VkDescriptorSet set = make_scene(app);
  Canvas canvas(app, Canvas::Way::kRendering, kVertexStages);
  const Buffer indices = app.make_buffer(std::vector<std::uint32_t>{0, 1, 2});
  const Buffer plain = app.make_buffer(std::vector<std::uint32_t>{3, 1, 0, 0});
  const Buffer indexed = app.make_buffer(std::vector<std::uint32_t>{3, 1, 0, 0, 0});
  const Buffer one = app.make_buffer(std::vector<std::uint32_t>{1});
  constexpr std::uint32_t kPlain = sizeof(VkDrawIndirectCommand);
  constexpr std::uint32_t kIndexed = sizeof(VkDrawIndexedIndirectCommand);
  const std::vector<Draw> draws = {
      [](VkCommandBuffer c) { vkCmdDrawIndexed(c, 3, 1, 0, 0, 0); },
      [&](VkCommandBuffer c) { vkCmdDrawIndirect(c, plain.handle, 0, 1, kPlain); },
      [&](VkCommandBuffer c) { vkCmdDrawIndexedIndirect(c, indexed.handle, 0, 1, kIndexed); },
      [&](VkCommandBuffer c) {
        vkCmdDrawIndirectCount(c, plain.handle, 0, one.handle, 0, 1, kPlain);
      },
      [&](VkCommandBuffer c) {
        vkCmdDrawIndexedIndirectCount(c, indexed.handle, 0, one.handle, 0, 1, kIndexed);
      }};
  app.run([&](VkCommandBuffer commands) {
    vkCmdBindIndexBuffer(commands, indices.handle, 0, VK_INDEX_TYPE_UINT32);
    for (const Draw& draw : draws) {
      pass(canvas, commands, set, draw);
    }
  });
}

void multi_draw(App& app) {
  const auto plain = load<PFN_vkCmdDrawMultiEXT>(app, "vkCmdDrawMultiEXT");
  const auto indexed = load<PFN_vkCmdDrawMultiIndexedEXT>(app, "vkCmdDrawMultiIndexedEXT");
  const VkDescriptorSet set = make_scene(app);
  Canvas canvas(app, Canvas::Way::kRenderPass, kVertexStages);
  const Buffer indices = app.make_buffer(std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5});
  app.run([&](VkCommandBuffer commands) {
    pass(canvas, commands, set, [&](VkCommandBuffer c) {
      const std::array<VkMultiDrawInfoEXT, 2> list = {{{0, 3}, {3, 3}}};
      plain(c, static_cast<std::uint32_t>(list.size()), list.data(), 1, 0, sizeof(list[0]));
    });
    vkCmdBindIndexBuffer(commands, indices.handle, 0, VK_INDEX_TYPE_UINT32);
    pass(canvas, commands, set, [&](VkCommandBuffer c) {
      const std::array<VkMultiDrawIndexedInfoEXT, 2> list = {{{0, 3, 0}, {3, 3, 0}}};
      indexed(c, static_cast<std::uint32_t>(list.size()), list.data(), 1, 0, sizeof(list[0]),
              nullptr);
    });
  });
}

void mesh(App& app) {
  const auto tasks = load<PFN_vkCmdDrawMeshTasksEXT>(app, "vkCmdDrawMeshTasksEXT");
  const auto indirect =
      load<PFN_vkCmdDrawMeshTasksIndirectEXT>(app, "vkCmdDrawMeshTasksIndirectEXT");
  const auto counted =
      load<PFN_vkCmdDrawMeshTasksIndirectCountEXT>(app, "vkCmdDrawMeshTasksIndirectCountEXT");
  const VkDescriptorSet set = make_scene(app);
  Canvas canvas(app, Canvas::Way::kRendering, kMeshStages);
  const Buffer groups = app.make_buffer(std::vector<std::uint32_t>{1, 1, 1});
  const Buffer one = app.make_buffer(std::vector<std::uint32_t>{1});
  constexpr std::uint32_t kStride = sizeof(VkDrawMeshTasksIndirectCommandEXT);
  const std::vector<Draw> draws = {
      [&](VkCommandBuffer c) { tasks(c, 1, 1, 1); },
      [&](VkCommandBuffer c) { indirect(c, groups.handle, 0, 1, kStride); },
      [&](VkCommandBuffer c) { counted(c, groups.handle, 0, one.handle, 0, 1, kStride); }};
  app.run([&](VkCommandBuffer commands) {
    for (const Draw& draw : draws) {
      pass(canvas, commands, set, draw);
    }
  });
}

// The first pass traces in its vertex shader and writes what it found by transform feedback; the
// second draws as many vertices as the first wrote. The feedback's bytes end in the picture.
void feedback(App& app) {
  const auto bind =
      load<PFN_vkCmdBindTransformFeedbackBuffersEXT>(app, "vkCmdBindTransformFeedbackBuffersEXT");
  const auto begin =
      load<PFN_vkCmdBeginTransformFeedbackEXT>(app, "vkCmdBeginTransformFeedbackEXT");
  const auto end = load<PFN_vkCmdEndTransformFeedbackEXT>(app, "vkCmdEndTransformFeedbackEXT");
  const auto draw_written =
      load<PFN_vkCmdDrawIndirectByteCountEXT>(app, "vkCmdDrawIndirectByteCountEXT");
  const VkDescriptorSet set = make_scene(app);
  Canvas writing(app, Canvas::Way::kRenderPass, kFeedbackStages);
  Canvas drawing(app, Canvas::Way::kRenderPass, kVertexStages);
  const Buffer written = app.make_buffer(3 * kVertexBytes);
  const Buffer counter = app.make_buffer(sizeof(std::uint32_t));
  const VkDeviceSize zero = 0;
  app.run([&](VkCommandBuffer commands) {
    pass(writing, commands, set, [&](VkCommandBuffer c) {
      bind(c, 0, 1, &written.handle, &zero, &written.size);
      begin(c, 0, 1, &counter.handle, &zero);
      vkCmdDraw(c, 3, 1, 0, 0);
      end(c, 0, 1, &counter.handle, &zero);
    });
    pass(drawing, commands, set,
         [&](VkCommandBuffer c) { draw_written(c, 1, 0, counter.handle, 0, 0, kVertexBytes); });
    const VkBufferCopy copy{0, 0, written.size};
    vkCmdCopyBuffer(commands, written.handle, app.picture().handle, 1, &copy);
    App::barrier(commands);
  });
}

const Program by_index("query_draws", indexed_and_indirect);
const Program by_multi_draw("query_multi_draw", multi_draw);
const Program by_mesh("query_mesh", mesh);
const Program by_feedback("query_feedback", feedback);
}  // namespace
