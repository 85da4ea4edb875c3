#include "harness/app.h"

#include <algorithm>
#include <array>
#include <utility>

namespace foreign {
namespace {

constexpr std::array kExtensions = {VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                                    VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME,
                                    VK_KHR_RAY_QUERY_EXTENSION_NAME,
                                    VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
                                    VK_KHR_PIPELINE_LIBRARY_EXTENSION_NAME,
                                    VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME,
                                    VK_KHR_RAY_TRACING_MAINTENANCE_1_EXTENSION_NAME,
                                    VK_EXT_MESH_SHADER_EXTENSION_NAME,
                                    VK_EXT_MULTI_DRAW_EXTENSION_NAME,
                                    VK_EXT_TRANSFORM_FEEDBACK_EXTENSION_NAME,
                                    "VK_KHR_maintenance6"};  // not in older headers
// Constant data, as it may be: who creates the device may only read it.
const VkPhysicalDeviceFeatures2 kPlain{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, nullptr, {}};

std::map<std::string, Run>& registered() {
  static std::map<std::string, Run> all;
  return all;
}

bool supports_ray_tracing(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> list(count);
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, list.data());
  return std::all_of(kExtensions.begin(), kExtensions.end(), [&](const char* wanted) {
    return std::any_of(list.begin(), list.end(), [wanted](const VkExtensionProperties& one) {
      return std::string(one.extensionName) == wanted;
    });
  });
}

}  // namespace

Program::Program(const char* name, Run run) { registered()[name] = run; }
const std::map<std::string, Run>& programs() { return registered(); }

Group general(std::uint32_t stage) {
  Group group;
  group.general = stage;
  return group;
}

Group hit(std::uint32_t closest_hit, std::uint32_t any_hit, std::uint32_t intersection) {
  Group group;
  group.type = intersection == VK_SHADER_UNUSED_KHR
                   ? VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR
                   : VK_RAY_TRACING_SHADER_GROUP_TYPE_PROCEDURAL_HIT_GROUP_KHR;
  group.closest_hit = closest_hit;
  group.any_hit = any_hit;
  group.intersection = intersection;
  return group;
}

App::App() {
  create_device();
  create_layouts();
  picture_ = make_buffer(std::uint64_t{kWidth} * kHeight * 4);
}

App::~App() {
  vkDeviceWaitIdle(device_);
  for (const VkPipeline pipeline : pipelines_) {
    vkDestroyPipeline(device_, pipeline, nullptr);
  }
  for (const auto& [name, module] : modules_) {
    vkDestroyShaderModule(device_, module, nullptr);
  }
  for (const Structure& structure : structures_) {
    vkDestroyAccelerationStructureKHR(device_, structure.handle, nullptr);
  }
  for (const Buffer& buffer : buffers_) {
    vkDestroyBuffer(device_, buffer.handle, nullptr);
    vkFreeMemory(device_, buffer.memory, nullptr);
  }
  vkDestroyFence(device_, fence_, nullptr);
  vkDestroyPipelineLayout(device_, layout_, nullptr);
  vkDestroyDescriptorSetLayout(device_, set_layout_, nullptr);
  vkDestroyDescriptorPool(device_, sets_, nullptr);
  vkDestroyCommandPool(device_, pool_, nullptr);
  vkDestroyDevice(device_, nullptr);
  vkDestroyInstance(instance_, nullptr);
}

void App::create_device() {
  VkApplicationInfo application{};
  application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
  application.apiVersion = VK_API_VERSION_1_3;
  VkInstanceCreateInfo create{};
  create.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  create.pApplicationInfo = &application;
  check(vkCreateInstance(&create, nullptr, &instance_), "vkCreateInstance");
  std::uint32_t count = 0;
  vkEnumeratePhysicalDevices(instance_, &count, nullptr);
  std::vector<VkPhysicalDevice> all(count);
  vkEnumeratePhysicalDevices(instance_, &count, all.data());
  const auto found = std::find_if(all.begin(), all.end(), supports_ray_tracing);
  if (found == all.end()) {
    throw std::runtime_error("no Vulkan device with ray-tracing pipelines and ray queries");
  }
  physical_ = *found;

  VkPhysicalDeviceTransformFeedbackFeaturesEXT feedback{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TRANSFORM_FEEDBACK_FEATURES_EXT,
      const_cast<VkPhysicalDeviceFeatures2*>(&kPlain), VK_TRUE, 0};
  VkPhysicalDeviceMultiDrawFeaturesEXT multi{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MULTI_DRAW_FEATURES_EXT, &feedback, VK_TRUE};
  VkPhysicalDeviceMeshShaderFeaturesEXT mesh{};
  mesh.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_EXT;
  mesh.pNext = &multi;
  mesh.meshShader = VK_TRUE;
  VkPhysicalDeviceRayTracingMaintenance1FeaturesKHR maintenance{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_MAINTENANCE_1_FEATURES_KHR, &mesh, VK_TRUE,
      VK_TRUE};
  VkPhysicalDeviceRayQueryFeaturesKHR query{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR, &maintenance, VK_TRUE};
  VkPhysicalDeviceRayTracingPipelineFeaturesKHR tracing{};
  tracing.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR;
  tracing.pNext = &query;
  tracing.rayTracingPipeline = VK_TRUE;
  tracing.rayTracingPipelineTraceRaysIndirect = VK_TRUE;
  VkPhysicalDeviceAccelerationStructureFeaturesKHR structures{};
  structures.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR;
  structures.pNext = &tracing;
  structures.accelerationStructure = VK_TRUE;
  VkPhysicalDeviceVulkan12Features twelve{};
  twelve.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
  twelve.pNext = &structures;
  twelve.bufferDeviceAddress = VK_TRUE;
  twelve.drawIndirectCount = VK_TRUE;
  VkPhysicalDeviceVulkan13Features thirteen{};
  thirteen.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
  thirteen.pNext = &twelve;
  thirteen.dynamicRendering = VK_TRUE;
  thirteen.synchronization2 = VK_TRUE;

  const float priority = 1;
  VkDeviceQueueCreateInfo queue{};
  queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkDeviceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  info.pNext = &thirteen;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.enabledExtensionCount = static_cast<std::uint32_t>(kExtensions.size());
  info.ppEnabledExtensionNames = kExtensions.data();
  check(vkCreateDevice(physical_, &info, nullptr, &device_), "vkCreateDevice");
  vkGetDeviceQueue(device_, 0, 0, &queue_);
#define FOREIGN_LOAD(name) name = reinterpret_cast<PFN_##name>(vkGetDeviceProcAddr(device_, #name));
  FOREIGN_FUNCTIONS(FOREIGN_LOAD)
#undef FOREIGN_LOAD
  VkCommandPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  check(vkCreateCommandPool(device_, &pool, nullptr, &pool_), "vkCreateCommandPool");
  VkFenceCreateInfo fence{};
  fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
  check(vkCreateFence(device_, &fence, nullptr, &fence_), "vkCreateFence");
}

void App::create_layouts() {
  std::array<VkDescriptorSetLayoutBinding, 4> bindings{};
  for (std::uint32_t i = 0; i < bindings.size(); ++i) {
    const bool structure = i == 0 || i == 3;
    bindings[i] = {i,
                   structure ? VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR
                             : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                   1, VK_SHADER_STAGE_ALL, nullptr};
  }
  VkDescriptorSetLayoutCreateInfo set{};
  set.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  set.bindingCount = static_cast<std::uint32_t>(bindings.size());
  set.pBindings = bindings.data();
  check(vkCreateDescriptorSetLayout(device_, &set, nullptr, &set_layout_), "set layout");
  const VkPushConstantRange constants{VK_SHADER_STAGE_ALL, 0, 16};
  VkPipelineLayoutCreateInfo layout{};
  layout.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &set_layout_;
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &constants;
  check(vkCreatePipelineLayout(device_, &layout, nullptr, &layout_), "pipeline layout");
  const std::array<VkDescriptorPoolSize, 2> sizes = {
      {{VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 16},
       {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 16}}};
  VkDescriptorPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  pool.maxSets = 8;
  pool.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
  pool.pPoolSizes = sizes.data();
  check(vkCreateDescriptorPool(device_, &pool, nullptr, &sets_), "descriptor pool");
}

std::uint32_t App::memory_type(std::uint32_t allowed, VkMemoryPropertyFlags flags) const {
  VkPhysicalDeviceMemoryProperties memory{};
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory);
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    if ((allowed >> i & 1u) != 0 && (memory.memoryTypes[i].propertyFlags & flags) == flags) {
      return i;
    }
  }
  throw std::runtime_error("no host-visible memory");
}

Buffer App::make_buffer(VkDeviceSize size, const void* data) {
  Buffer buffer;
  buffer.size = size;
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = std::max<VkDeviceSize>(size, 16);
  info.usage = VK_BUFFER_USAGE_TRANSFORM_FEEDBACK_BUFFER_BIT_EXT |
               VK_BUFFER_USAGE_TRANSFORM_FEEDBACK_COUNTER_BUFFER_BIT_EXT |
               VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
               VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
               VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR |
               VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR |
               VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
               VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
  check(vkCreateBuffer(device_, &info, nullptr, &buffer.handle), "vkCreateBuffer");
  VkMemoryRequirements needs{};
  vkGetBufferMemoryRequirements(device_, buffer.handle, &needs);
  VkMemoryAllocateFlagsInfo flags{};
  flags.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO;
  flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  VkMemoryAllocateInfo allocation{};
  allocation.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  allocation.pNext = &flags;
  allocation.allocationSize = needs.size;
  allocation.memoryTypeIndex =
      memory_type(needs.memoryTypeBits,
                  VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  check(vkAllocateMemory(device_, &allocation, nullptr, &buffer.memory), "vkAllocateMemory");
  check(vkBindBufferMemory(device_, buffer.handle, buffer.memory, 0), "vkBindBufferMemory");
  check(vkMapMemory(device_, buffer.memory, 0, VK_WHOLE_SIZE, 0, &buffer.mapped), "vkMapMemory");
  const VkBufferDeviceAddressInfo query{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, nullptr,
                                        buffer.handle};
  buffer.address = vkGetBufferDeviceAddress(device_, &query);
  if (data != nullptr) {
    std::memcpy(buffer.mapped, data, size);
  } else {
    std::memset(buffer.mapped, 0, size);
  }
  buffers_.push_back(buffer);
  return buffer;
}

Geometry App::triangles(const Mesh& mesh, VkGeometryFlagsKHR flags) {
  Geometry geometry;
  auto& description = geometry.description;
  description.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR;
  description.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
  description.flags = flags;
  auto& data = description.geometry.triangles;
  data.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR;
  data.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
  data.vertexStride = 12;
  data.vertexData.deviceAddress = make_buffer(mesh.positions).address;
  data.maxVertex = static_cast<std::uint32_t>(mesh.positions.size() / 3) - 1;
  data.indexType = VK_INDEX_TYPE_UINT32;
  data.indexData.deviceAddress = make_buffer(mesh.indices).address;
  geometry.range.primitiveCount = static_cast<std::uint32_t>(mesh.indices.size() / 3);
  return geometry;
}

Geometry App::boxes(const std::vector<VkAabbPositionsKHR>& list, VkGeometryFlagsKHR flags) {
  Geometry geometry;
  auto& description = geometry.description;
  description.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR;
  description.geometryType = VK_GEOMETRY_TYPE_AABBS_KHR;
  description.flags = flags;
  auto& data = description.geometry.aabbs;
  data.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_AABBS_DATA_KHR;
  data.stride = sizeof(VkAabbPositionsKHR);
  data.data.deviceAddress = make_buffer(list).address;
  geometry.range.primitiveCount = static_cast<std::uint32_t>(list.size());
  return geometry;
}

Geometry App::instances(const std::vector<VkAccelerationStructureInstanceKHR>& list) {
  Geometry geometry;
  auto& description = geometry.description;
  description.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR;
  description.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
  auto& data = description.geometry.instances;
  data.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR;
  data.data.deviceAddress = make_buffer(list).address;
  geometry.range.primitiveCount = static_cast<std::uint32_t>(list.size());
  return geometry;
}

VkAccelerationStructureInstanceKHR App::instance(const Structure& blas,
                                                 const VkTransformMatrixKHR& transform,
                                                 std::uint32_t custom) {
  VkAccelerationStructureInstanceKHR out{};
  out.transform = transform;
  out.instanceCustomIndex = custom & 0xffffffu;
  out.mask = 0xff;
  out.accelerationStructureReference = blas.address;
  return out;
}

namespace {

struct BuildInfo {
  std::vector<VkAccelerationStructureGeometryKHR> geometries;
  std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges;
  std::vector<std::uint32_t> counts;
  VkAccelerationStructureBuildGeometryInfoKHR info{};
};

// Filled in place: the info points into its own vectors.
void describe(const StructureInput& input, BuildInfo& out) {
  for (const Geometry& geometry : input.geometries) {
    out.geometries.push_back(geometry.description);
    out.ranges.push_back(geometry.range);
    out.counts.push_back(geometry.range.primitiveCount);
  }
  out.info.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR;
  out.info.type = input.type;
  out.info.flags = input.flags;
  out.info.geometryCount = static_cast<std::uint32_t>(out.geometries.size());
  out.info.pGeometries = out.geometries.data();
}

}  // namespace

Structure App::make_structure(VkAccelerationStructureTypeKHR type, VkDeviceSize size) {
  Structure structure;
  structure.buffer = make_buffer(size);
  VkAccelerationStructureCreateInfoKHR info{};
  info.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR;
  info.buffer = structure.buffer.handle;
  info.size = size;
  info.type = type;
  check(vkCreateAccelerationStructureKHR(device_, &info, nullptr, &structure.handle),
        "vkCreateAccelerationStructureKHR");
  const VkAccelerationStructureDeviceAddressInfoKHR query{
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR, nullptr, structure.handle};
  structure.address = vkGetAccelerationStructureDeviceAddressKHR(device_, &query);
  structures_.push_back(structure);
  return structure;
}

Structure App::make_structure(const StructureInput& input) {
  BuildInfo build;
  describe(input, build);
  VkAccelerationStructureBuildSizesInfoKHR sizes{};
  sizes.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR;
  vkGetAccelerationStructureBuildSizesKHR(device_, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR,
                                          &build.info, build.counts.data(), &sizes);
  return make_structure(input.type, sizes.accelerationStructureSize);
}

void App::build(VkCommandBuffer commands, const StructureInput& input, const Structure& target,
                VkBuildAccelerationStructureModeKHR mode) {
  BuildInfo build;
  describe(input, build);
  build.info.mode = mode;
  build.info.dstAccelerationStructure = target.handle;
  build.info.srcAccelerationStructure =
      mode == VK_BUILD_ACCELERATION_STRUCTURE_MODE_UPDATE_KHR ? target.handle : VK_NULL_HANDLE;
  VkAccelerationStructureBuildSizesInfoKHR sizes{};
  sizes.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR;
  vkGetAccelerationStructureBuildSizesKHR(device_, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR,
                                          &build.info, build.counts.data(), &sizes);
  build.info.scratchData.deviceAddress =
      make_buffer(std::max(sizes.buildScratchSize, sizes.updateScratchSize)).address;
  const VkAccelerationStructureBuildRangeInfoKHR* ranges = build.ranges.data();
  vkCmdBuildAccelerationStructuresKHR(commands, 1, &build.info, &ranges);
  barrier(commands);
}

Structure App::build_now(const StructureInput& input) {
  const Structure structure = make_structure(input);
  run([&](VkCommandBuffer commands) { build(commands, input, structure); });
  return structure;
}

Structure App::blas(std::vector<Geometry> geometries) {
  StructureInput input;
  input.geometries = std::move(geometries);
  return build_now(input);
}

Structure App::tlas(const std::vector<VkAccelerationStructureInstanceKHR>& list) {
  StructureInput input;
  input.type = VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR;
  input.geometries = {instances(list)};
  return build_now(input);
}

VkShaderModule App::module(const std::string& shader) {
  VkShaderModule& module = modules_[shader];
  if (module == VK_NULL_HANDLE) {
    const auto words = shader_words(shader);
    VkShaderModuleCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
    info.codeSize = words.size_bytes();
    info.pCode = words.data();
    check(vkCreateShaderModule(device_, &info, nullptr, &module), "vkCreateShaderModule");
  }
  return module;
}

VkPipelineShaderStageCreateInfo App::stage_info(const Stage& stage) {
  VkPipelineShaderStageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage = stage.stage;
  info.module = module(stage.shader);
  info.pName = "main";
  return info;
}

namespace {

std::vector<VkRayTracingShaderGroupCreateInfoKHR> group_infos(const std::vector<Group>& groups) {
  std::vector<VkRayTracingShaderGroupCreateInfoKHR> out;
  for (const Group& group : groups) {
    VkRayTracingShaderGroupCreateInfoKHR info{};
    info.sType = VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR;
    info.type = group.type;
    info.generalShader = group.general;
    info.closestHitShader = group.closest_hit;
    info.anyHitShader = group.any_hit;
    info.intersectionShader = group.intersection;
    out.push_back(info);
  }
  return out;
}

}  // namespace

RayPipeline App::ray_pipeline(const std::vector<Stage>& stages, const std::vector<Group>& groups,
                              TableShape shape, std::uint32_t recursion, VkPipelineLayout layout) {
  std::vector<VkPipelineShaderStageCreateInfo> stage_infos;
  for (const Stage& stage : stages) {
    stage_infos.push_back(stage_info(stage));
  }
  const auto groups_created = group_infos(groups);
  VkRayTracingPipelineCreateInfoKHR info{};
  info.sType = VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR;
  info.stageCount = static_cast<std::uint32_t>(stage_infos.size());
  info.pStages = stage_infos.data();
  info.groupCount = static_cast<std::uint32_t>(groups_created.size());
  info.pGroups = groups_created.data();
  info.maxPipelineRayRecursionDepth = recursion;
  info.layout = layout != VK_NULL_HANDLE ? layout : layout_;
  RayPipeline pipeline;
  check(vkCreateRayTracingPipelinesKHR(device_, VK_NULL_HANDLE, VK_NULL_HANDLE, 1, &info, nullptr,
                                       &pipeline.handle),
        "vkCreateRayTracingPipelinesKHR");
  fill_table(pipeline, info.groupCount, shape);
  return pipeline;
}

void App::fill_table(RayPipeline& pipeline, std::uint32_t groups, TableShape shape) {
  constexpr std::uint32_t kHandle = 32;
  constexpr std::uint32_t kStride = 64;
  pipelines_.push_back(pipeline.handle);
  std::vector<std::uint8_t> handles(std::size_t{groups} * kHandle);
  check(vkGetRayTracingShaderGroupHandlesKHR(device_, pipeline.handle, 0, groups, handles.size(),
                                             handles.data()),
        "vkGetRayTracingShaderGroupHandlesKHR");
  pipeline.table = make_buffer(std::uint64_t{groups} * kStride);
  for (std::size_t i = 0; i < groups; ++i) {
    auto* entry = static_cast<std::uint8_t*>(pipeline.table.mapped) + i * kStride;
    std::memcpy(entry, handles.data() + i * kHandle, kHandle);
    // Shader-record data behind the handle: the number of the group.
    const auto number = static_cast<std::uint32_t>(i);
    std::memcpy(entry + kHandle, &number, sizeof(number));
  }
  VkDeviceAddress at = pipeline.table.address;
  const auto take = [&at](std::uint32_t count) {
    const VkStridedDeviceAddressRegionKHR region{count == 0 ? 0 : at, kStride,
                                                 std::uint64_t{count} * kStride};
    at += std::uint64_t{count} * kStride;
    return region;
  };
  pipeline.raygen = take(1);
  pipeline.miss = take(shape.miss);
  pipeline.hit = take(shape.hit);
  pipeline.callable = take(shape.callable);
}

VkPipeline App::compute_pipeline(const std::string& shader) {
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.stage = stage_info({VK_SHADER_STAGE_COMPUTE_BIT, shader});
  info.layout = layout_;
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateComputePipelines(device_, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
        "vkCreateComputePipelines");
  pipelines_.push_back(pipeline);
  return pipeline;
}

VkDescriptorSet App::make_set(const Structure& tlas, const Buffer* more, const Structure* second) {
  VkDescriptorSetAllocateInfo allocation{};
  allocation.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  allocation.descriptorPool = sets_;
  allocation.descriptorSetCount = 1;
  allocation.pSetLayouts = &set_layout_;
  VkDescriptorSet set = VK_NULL_HANDLE;
  check(vkAllocateDescriptorSets(device_, &allocation, &set), "vkAllocateDescriptorSets");
  const std::array handles = {tlas.handle, second != nullptr ? second->handle : tlas.handle};
  std::array<VkWriteDescriptorSetAccelerationStructureKHR, 2> structures{};
  const std::array buffers = {
      VkDescriptorBufferInfo{picture_.handle, 0, VK_WHOLE_SIZE},
      VkDescriptorBufferInfo{more != nullptr ? more->handle : picture_.handle, 0, VK_WHOLE_SIZE}};
  std::array<VkWriteDescriptorSet, 4> writes{};
  for (std::uint32_t i = 0; i < writes.size(); ++i) {
    writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    writes[i].dstSet = set;
    writes[i].dstBinding = i;
    writes[i].descriptorCount = 1;
    if (i == 0 || i == 3) {
      auto& structure = structures[i / 3];
      structure.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR;
      structure.accelerationStructureCount = 1;
      structure.pAccelerationStructures = &handles[i / 3];
      writes[i].descriptorType = VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR;
      writes[i].pNext = &structure;
    } else {
      writes[i].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
      writes[i].pBufferInfo = &buffers[i - 1];
    }
  }
  vkUpdateDescriptorSets(device_, static_cast<std::uint32_t>(writes.size()), writes.data(), 0,
                         nullptr);
  return set;
}

VkCommandBuffer App::make_commands(VkCommandBufferLevel level) {
  VkCommandBufferAllocateInfo allocation{};
  allocation.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  allocation.commandPool = pool_;
  allocation.level = level;
  allocation.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  check(vkAllocateCommandBuffers(device_, &allocation, &commands), "vkAllocateCommandBuffers");
  return commands;
}

void App::begin(VkCommandBuffer commands, VkCommandBufferUsageFlags flags) {
  VkCommandBufferInheritanceInfo inheritance{};
  inheritance.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_INHERITANCE_INFO;
  VkCommandBufferBeginInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  info.flags = flags;
  info.pInheritanceInfo = &inheritance;
  check(vkBeginCommandBuffer(commands, &info), "vkBeginCommandBuffer");
}

void App::trace(VkCommandBuffer commands, const RayPipeline& pipeline, VkDescriptorSet set) {
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, pipeline.handle);
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, layout_, 0, 1, &set, 0,
                          nullptr);
  vkCmdTraceRaysKHR(commands, &pipeline.raygen, &pipeline.miss, &pipeline.hit, &pipeline.callable,
                    kWidth, kHeight, 1);
  barrier(commands);
}

void App::submit(VkCommandBuffer commands) {
  VkSubmitInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  info.commandBufferCount = 1;
  info.pCommandBuffers = &commands;
  check(vkQueueSubmit(queue_, 1, &info, fence_), "vkQueueSubmit");
  check(vkWaitForFences(device_, 1, &fence_, VK_TRUE, UINT64_MAX), "vkWaitForFences");
  check(vkResetFences(device_, 1, &fence_), "vkResetFences");
}

void App::run(const std::function<void(VkCommandBuffer)>& record) {
  const VkCommandBuffer commands = make_commands();
  begin(commands, VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT);
  record(commands);
  check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
  submit(commands);
  vkFreeCommandBuffers(device_, pool_, 1, &commands);
}

void App::barrier(VkCommandBuffer commands) {
  const VkMemoryBarrier all{VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr, VK_ACCESS_MEMORY_WRITE_BIT,
                            VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT};
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                       VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 1, &all, 0, nullptr, 0, nullptr);
}

}  // namespace foreign
