// The hit group stands in a pipeline library with inline shader code; the pipeline is linked as a
// deferred operation; the structure is pushed into the command buffer.
#include <array>

#include "harness/push_layout.h"

namespace {
using namespace foreign;

constexpr VkRayTracingPipelineInterfaceCreateInfoKHR kInterface{
    VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_INTERFACE_CREATE_INFO_KHR, nullptr, 16, 8};

VkPipeline make_library(App& app, VkPipelineLayout layout) {
  const auto words = shader_words("color.rchit");
  VkShaderModuleCreateInfo code{};
  code.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  code.codeSize = words.size_bytes();
  code.pCode = words.data();
  VkPipelineShaderStageCreateInfo stage{};
  stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  stage.pNext = &code;
  stage.stage = VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR;
  stage.pName = "main";
  VkRayTracingShaderGroupCreateInfoKHR group{};
  group.sType = VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR;
  group.type = VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR;
  group.generalShader = group.anyHitShader = group.intersectionShader = VK_SHADER_UNUSED_KHR;
  group.closestHitShader = 0;
  VkRayTracingPipelineCreateInfoKHR info{};
  info.sType = VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR;
  info.flags = VK_PIPELINE_CREATE_LIBRARY_BIT_KHR;
  info.stageCount = 1;
  info.pStages = &stage;
  info.groupCount = 1;
  info.pGroups = &group;
  info.maxPipelineRayRecursionDepth = 1;
  info.pLibraryInterface = &kInterface;
  info.layout = layout;
  VkPipeline library = VK_NULL_HANDLE;
  check(app.vkCreateRayTracingPipelinesKHR(app.device(), VK_NULL_HANDLE, VK_NULL_HANDLE, 1, &info,
                                           nullptr, &library),
        "library");
  return library;
}

RayPipeline link(App& app, VkPipelineLayout layout, VkPipeline library) {
  const std::array stages = {app.stage_info({VK_SHADER_STAGE_RAYGEN_BIT_KHR, "simple.rgen"}),
                             app.stage_info({VK_SHADER_STAGE_MISS_BIT_KHR, "simple.rmiss"})};
  std::array<VkRayTracingShaderGroupCreateInfoKHR, 2> groups{};
  for (std::uint32_t i = 0; i < groups.size(); ++i) {
    groups[i].sType = VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR;
    groups[i].type = VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR;
    groups[i].generalShader = i;
    groups[i].closestHitShader = groups[i].anyHitShader = VK_SHADER_UNUSED_KHR;
    groups[i].intersectionShader = VK_SHADER_UNUSED_KHR;
  }
  const VkPipelineLibraryCreateInfoKHR libraries{VK_STRUCTURE_TYPE_PIPELINE_LIBRARY_CREATE_INFO_KHR,
                                                 nullptr, 1, &library};
  VkRayTracingPipelineCreateInfoKHR info{};
  info.sType = VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR;
  info.stageCount = static_cast<std::uint32_t>(stages.size());
  info.pStages = stages.data();
  info.groupCount = static_cast<std::uint32_t>(groups.size());
  info.pGroups = groups.data();
  info.maxPipelineRayRecursionDepth = 1;
  info.pLibraryInfo = &libraries;
  info.pLibraryInterface = &kInterface;
  info.layout = layout;
  VkDeferredOperationKHR operation = VK_NULL_HANDLE;
  check(app.vkCreateDeferredOperationKHR(app.device(), nullptr, &operation), "deferred operation");
  RayPipeline pipeline;
  check(app.vkCreateRayTracingPipelinesKHR(app.device(), operation, VK_NULL_HANDLE, 1, &info,
                                           nullptr, &pipeline.handle),
        "linked pipeline");
  app.vkDestroyDeferredOperationKHR(app.device(), operation, nullptr);
  app.fill_table(pipeline, 3, {1, 1, 0});
  return pipeline;
}

void run(App& app) {
  const Structure grid = app.blas({app.triangles(wavy_grid(10))});
  const Structure tlas = app.tlas({App::instance(grid, translation(0, 0, 0))});
  const PushLayout push(app);
  const VkPipelineLayout layout = push.layout();
  const VkPipeline library = make_library(app, layout);
  const RayPipeline pipeline = link(app, layout, library);

  const PushWrites writes(app, tlas);
  app.run([&](VkCommandBuffer commands) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, pipeline.handle);
    app.vkCmdPushDescriptorSetKHR(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, layout, 0,
                                  static_cast<std::uint32_t>(writes.list.size()),
                                  writes.list.data());
    const std::uint32_t zero[2] = {0, 0};
    vkCmdPushConstants(commands, layout, VK_SHADER_STAGE_ALL, 0, sizeof(zero), zero);
    app.vkCmdTraceRaysKHR(commands, &pipeline.raygen, &pipeline.miss, &pipeline.hit,
                          &pipeline.callable, kWidth, kHeight, 1);
    App::barrier(commands);
  });
  vkDestroyPipeline(app.device(), library, nullptr);
}
const Program program("library", run);
}  // namespace
