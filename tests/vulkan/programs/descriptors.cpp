// The ways to hand a structure to a shader besides vkUpdateDescriptorSets: an update template, and
// pushes with and without a template, in the forms of Vulkan 1.1 and of VK_KHR_maintenance6.
#include "harness/push_layout.h"

namespace {
using namespace foreign;

// The structures of VK_KHR_maintenance6, which older headers lack.
struct BindSets2 {
  VkStructureType type = static_cast<VkStructureType>(1000545003);
  const void* next = nullptr;
  VkShaderStageFlags stages = VK_SHADER_STAGE_RAYGEN_BIT_KHR | VK_SHADER_STAGE_MISS_BIT_KHR |
                              VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  std::uint32_t first = 0;
  std::uint32_t count = 1;
  const VkDescriptorSet* sets = nullptr;
  std::uint32_t offset_count = 0;
  const std::uint32_t* offsets = nullptr;
};
struct PushConstants2 {
  VkStructureType type = static_cast<VkStructureType>(1000545004);
  const void* next = nullptr;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkShaderStageFlags stages = VK_SHADER_STAGE_ALL;
  std::uint32_t offset = 0;
  std::uint32_t size = 0;
  const void* values = nullptr;
};
struct PushSet2 {
  VkStructureType type = static_cast<VkStructureType>(1000545005);
  const void* next = nullptr;
  VkShaderStageFlags stages = BindSets2{}.stages;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  std::uint32_t set = 0;
  std::uint32_t count = 0;
  const VkWriteDescriptorSet* writes = nullptr;
};
struct PushTemplate2 {
  VkStructureType type = static_cast<VkStructureType>(1000545006);
  const void* next = nullptr;
  VkDescriptorUpdateTemplate update = VK_NULL_HANDLE;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  std::uint32_t set = 0;
  const void* data = nullptr;
};

// Throws if the driver lacks the function.
template <class Info>
void call(App& app, const char* function, VkCommandBuffer commands, const Info& info) {
  using Function = void(VKAPI_PTR*)(VkCommandBuffer, const Info*);
  const auto pointer = reinterpret_cast<Function>(vkGetDeviceProcAddr(app.device(), function));
  if (pointer == nullptr) {
    throw std::runtime_error(std::string("the driver has no ") + function);
  }
  pointer(commands, &info);
}

RayPipeline make_pipeline(App& app, VkPipelineLayout layout) {
  return app.ray_pipeline({{VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"},
                           {VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"},
                           {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, "color.rchit"}},
                          {general(0), general(1), hit(2)}, {1, 1, 0}, 1, layout);
}

Structure make_scene(App& app) {
  const Structure grid = app.blas({app.triangles(wavy_grid(10))});
  return app.tlas({App::instance(grid, translation(0, 0, 0)),
                   App::instance(grid, translation(0.4f, 0.3f, -0.6f))});
}

void trace(App& app, VkCommandBuffer commands, const RayPipeline& pipeline) {
  app.vkCmdTraceRaysKHR(commands, &pipeline.raygen, &pipeline.miss, &pipeline.hit,
                        &pipeline.callable, kWidth, kHeight, 1);
  App::barrier(commands);
}

constexpr std::uint32_t kMix[2] = {0, 1};  // mix with the picture so far

void templates(App& app) {
  const Structure scene = make_scene(app);
  // The set first holds another structure; only the template's write is right.
  const Structure block = app.blas({app.triangles(cube())});
  const Structure wrong = app.tlas({App::instance(block, translation(0, 9, 0))});
  const VkDescriptorSet set = app.make_set(wrong);
  const VkDescriptorUpdateTemplate update = make_template(app, app.set_layout(), VK_NULL_HANDLE);
  const TemplateData data{scene.handle, {app.picture().handle, 0, VK_WHOLE_SIZE}};
  vkUpdateDescriptorSetWithTemplate(app.device(), set, update, &data);
  const RayPipeline pipeline = make_pipeline(app, app.layout());
  app.run([&](VkCommandBuffer commands) {
    app.trace(commands, pipeline, set);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, pipeline.handle);
    BindSets2 bind;
    bind.layout = app.layout();
    bind.sets = &set;
    call(app, "vkCmdBindDescriptorSets2KHR", commands, bind);
    PushConstants2 constants;
    constants.layout = app.layout();
    constants.size = sizeof(kMix);
    constants.values = kMix;
    call(app, "vkCmdPushConstants2KHR", commands, constants);
    trace(app, commands, pipeline);
  });
  vkDestroyDescriptorUpdateTemplate(app.device(), update, nullptr);
}

void pushes(App& app) {
  const Structure scene = make_scene(app);
  const PushLayout layout(app);
  const RayPipeline pipeline = make_pipeline(app, layout.layout());
  const PushWrites writes(app, scene);
  const VkDescriptorUpdateTemplate update = make_template(app, VK_NULL_HANDLE, layout.layout());
  const TemplateData data{scene.handle, writes.picture};
  const auto with_template = reinterpret_cast<PFN_vkCmdPushDescriptorSetWithTemplateKHR>(
      vkGetDeviceProcAddr(app.device(), "vkCmdPushDescriptorSetWithTemplateKHR"));
  // Each command buffer begins with nothing bound.
  const auto draw = [&](const std::function<void(VkCommandBuffer)>& push) {
    app.run([&](VkCommandBuffer commands) {
      vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, pipeline.handle);
      vkCmdPushConstants(commands, layout.layout(), VK_SHADER_STAGE_ALL, 0, sizeof(kMix), kMix);
      push(commands);
      trace(app, commands, pipeline);
    });
  };
  draw([&](VkCommandBuffer commands) {
    with_template(commands, update, layout.layout(), 0, &data);
  });
  draw([&](VkCommandBuffer commands) {
    PushSet2 push;
    push.layout = layout.layout();
    push.count = static_cast<std::uint32_t>(writes.list.size());
    push.writes = writes.list.data();
    call(app, "vkCmdPushDescriptorSet2KHR", commands, push);
  });
  draw([&](VkCommandBuffer commands) {
    PushTemplate2 push;
    push.update = update;
    push.layout = layout.layout();
    push.data = &data;
    call(app, "vkCmdPushDescriptorSetWithTemplate2KHR", commands, push);
  });
  vkDestroyDescriptorUpdateTemplate(app.device(), update, nullptr);
}

const Program by_template("templates", templates);
const Program by_push("pushes", pushes);
}  // namespace
