// Ray queries in fragment shaders: by dynamic rendering, in a render pass, from secondary command
// buffers.
#include "harness/canvas.h"

namespace {
using namespace foreign;

const std::vector<Stage> kVertexStages = {{VK_SHADER_STAGE_VERTEX_BIT, "full.vert"},
                                          {VK_SHADER_STAGE_FRAGMENT_BIT, "query.frag"}};

VkDescriptorSet make_scene(App& app) {
  const Structure grid = app.blas({app.triangles(wavy_grid(12), 0)});
  return app.make_set(app.tlas(
      {App::instance(grid, translation(0, 0, 0)), App::instance(grid, translation(0, 0, -1))}));
}

void draw_with(App& app, Canvas::Way way, const std::vector<Stage>& stages,
               const std::function<void(VkCommandBuffer)>& draw) {
  const VkDescriptorSet set = make_scene(app);
  Canvas canvas(app, way, stages);
  app.run([&](VkCommandBuffer commands) {
    canvas.begin(commands);
    canvas.bind(commands, set);
    draw(commands);
    canvas.end(commands);
  });
}

void draw_all(VkCommandBuffer commands) { vkCmdDraw(commands, 3, 1, 0, 0); }

void dynamic_rendering(App& app) {
  draw_with(app, Canvas::Way::kRendering, kVertexStages, draw_all);
}

void render_pass(App& app) { draw_with(app, Canvas::Way::kRenderPass, kVertexStages, draw_all); }

// The draw stands in a secondary command buffer that continues the render pass.
void secondary_draw(App& app) {
  const VkDescriptorSet set = make_scene(app);
  Canvas canvas(app, Canvas::Way::kRenderPass, kVertexStages);
  const VkCommandBuffer draws = app.make_commands(VK_COMMAND_BUFFER_LEVEL_SECONDARY);
  VkCommandBufferInheritanceInfo inherited{};
  inherited.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_INHERITANCE_INFO;
  inherited.renderPass = canvas.pass();
  inherited.framebuffer = canvas.framebuffer();
  VkCommandBufferBeginInfo begin{};
  begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  begin.flags = VK_COMMAND_BUFFER_USAGE_RENDER_PASS_CONTINUE_BIT;
  begin.pInheritanceInfo = &inherited;
  check(vkBeginCommandBuffer(draws, &begin), "vkBeginCommandBuffer");
  canvas.bind(draws, set);
  draw_all(draws);
  check(vkEndCommandBuffer(draws), "vkEndCommandBuffer");
  app.run([&](VkCommandBuffer commands) {
    canvas.begin(commands, VK_SUBPASS_CONTENTS_SECONDARY_COMMAND_BUFFERS);
    vkCmdExecuteCommands(commands, 1, &draws);
    canvas.end(commands);
  });
}

// Four layers, of which the depth test hides all but the first.
void layers(App& app, Canvas::Hidden hidden) {
  const VkDescriptorSet set = make_scene(app);
  Canvas canvas(app, Canvas::Way::kRendering, kVertexStages, hidden);
  app.run([&](VkCommandBuffer commands) {
    canvas.begin(commands);
    canvas.bind(commands, set);
    for (int layer = 0; layer < 4; ++layer) {
      draw_all(commands);
    }
    canvas.end(commands);
  });
}

const Program by_depth("query_depth", [](App& app) { layers(app, Canvas::Hidden::kByDepth); });
const Program by_coverage("query_coverage",
                          [](App& app) { layers(app, Canvas::Hidden::kByDepthAndCoverage); });
const Program by_rendering("query_fragment", dynamic_rendering);
const Program by_pass("query_render_pass", render_pass);
const Program by_secondary("query_secondary", secondary_draw);
}  // namespace
