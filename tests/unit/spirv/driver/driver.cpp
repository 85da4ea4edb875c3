#include "driver.h"

#include <array>
#include <cstring>
#include <stdexcept>
#include <string>

namespace a2rt::spirv::testing {
namespace {

void check(VkResult result, const char* what) {
  if (result != VK_SUCCESS) {
    throw std::runtime_error(std::string(what) + " failed: " + std::to_string(result));
  }
}

template <class Info>
Info made(VkStructureType type, void* next = nullptr) {
  Info info{};
  info.sType = type;
  info.pNext = next;
  return info;
}

constexpr VkBufferUsageFlags kUsage =
    VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR |
    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR |
    VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR;

constexpr const char* kExtensions[] = {
    VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
    VK_KHR_RAY_QUERY_EXTENSION_NAME, VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME};

bool has_extensions(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> known(count);
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, known.data());
  for (const char* const wanted : kExtensions) {
    bool found = false;
    for (const auto& extension : known) {
      found |= std::strcmp(extension.extensionName, wanted) == 0;
    }
    if (!found) {
      return false;
    }
  }
  return true;
}

}  // namespace

Buffer::Buffer(Driver& driver, VkDeviceSize bytes) : device_(driver.device()) {
  auto info = made<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = bytes;
  info.usage = kUsage;
  check(vkCreateBuffer(device_, &info, nullptr, &buffer_), "vkCreateBuffer");
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device_, buffer_, &needs);
  auto flags = made<VkMemoryAllocateFlagsInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO);
  flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  auto allocate = made<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, &flags);
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = driver.memory_type();
  check(vkAllocateMemory(device_, &allocate, nullptr, &memory_), "vkAllocateMemory");
  check(vkBindBufferMemory(device_, buffer_, memory_, 0), "vkBindBufferMemory");
  check(vkMapMemory(device_, memory_, 0, VK_WHOLE_SIZE, 0, &mapped_), "vkMapMemory");
  std::memset(mapped_, 0, bytes);
  auto address = made<VkBufferDeviceAddressInfo>(VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO);
  address.buffer = buffer_;
  address_ = vkGetBufferDeviceAddress(device_, &address);
}

Buffer::~Buffer() {
  vkDestroyBuffer(device_, buffer_, nullptr);
  vkFreeMemory(device_, memory_, nullptr);
}

std::unique_ptr<Driver> Driver::open() {
  std::unique_ptr<Driver> driver(new Driver);
  if (!driver->create()) {
    return nullptr;
  }
  driver->build_scene();
  driver->create_descriptors();
  return driver;
}

bool Driver::create() {
  auto app = made<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  app.apiVersion = VK_API_VERSION_1_2;
  auto info = made<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  info.pApplicationInfo = &app;
  if (vkCreateInstance(&info, nullptr, &instance_) != VK_SUCCESS) {
    return false;
  }
  std::uint32_t count = 8;
  std::array<VkPhysicalDevice, 8> devices{};
  vkEnumeratePhysicalDevices(instance_, &count, devices.data());
  for (std::uint32_t i = 0; i < count && physical_ == VK_NULL_HANDLE; ++i) {
    auto driver =
        made<VkPhysicalDeviceDriverProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES);
    limits_.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR;
    driver.pNext = &limits_;
    auto properties =
        made<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &driver);
    vkGetPhysicalDeviceProperties2(devices[i], &properties);
    if (driver.driverID == VK_DRIVER_ID_MESA_LLVMPIPE && has_extensions(devices[i])) {
      physical_ = devices[i];
    }
  }
  if (physical_ == VK_NULL_HANDLE) {
    return false;
  }
  auto query = made<VkPhysicalDeviceRayQueryFeaturesKHR>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR);
  query.rayQuery = VK_TRUE;
  auto structure = made<VkPhysicalDeviceAccelerationStructureFeaturesKHR>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR, &query);
  structure.accelerationStructure = VK_TRUE;
  auto tracing = made<VkPhysicalDeviceRayTracingPipelineFeaturesKHR>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR, &structure);
  tracing.rayTracingPipeline = VK_TRUE;
  auto vulkan12 = made<VkPhysicalDeviceVulkan12Features>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &tracing);
  vulkan12.bufferDeviceAddress = VK_TRUE;
  const float priority = 1;
  auto queue = made<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  auto create = made<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &vulkan12);
  create.queueCreateInfoCount = 1;
  create.pQueueCreateInfos = &queue;
  create.enabledExtensionCount = static_cast<std::uint32_t>(std::size(kExtensions));
  create.ppEnabledExtensionNames = kExtensions;
  check(vkCreateDevice(physical_, &create, nullptr, &device_), "vkCreateDevice");
  vkGetDeviceQueue(device_, 0, 0, &queue_);
  auto pool = made<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  check(vkCreateCommandPool(device_, &pool, nullptr, &pool_), "vkCreateCommandPool");
  return true;
}

std::uint32_t Driver::memory_type() const {
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory);
  constexpr VkMemoryPropertyFlags kWanted =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    if ((memory.memoryTypes[i].propertyFlags & kWanted) == kWanted) {
      return i;
    }
  }
  throw std::runtime_error("no host-visible memory");
}

template <class Record>
void Driver::submit(Record record) {
  auto allocate = made<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  allocate.commandPool = pool_;
  allocate.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  check(vkAllocateCommandBuffers(device_, &allocate, &commands), "vkAllocateCommandBuffers");
  auto begin = made<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  check(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
  record(commands);
  check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
  auto submit = made<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands;
  check(vkQueueSubmit(queue_, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit");
  check(vkQueueWaitIdle(queue_), "vkQueueWaitIdle");
  vkFreeCommandBuffers(device_, pool_, 1, &commands);
}

Driver::Structure Driver::build(VkAccelerationStructureTypeKHR type,
                                std::span<const VkAccelerationStructureGeometryKHR> geometries,
                                std::uint32_t primitives) {
  auto info = made<VkAccelerationStructureBuildGeometryInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR);
  info.type = type;
  info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  info.geometryCount = static_cast<std::uint32_t>(geometries.size());
  info.pGeometries = geometries.data();
  const std::vector<std::uint32_t> counts(geometries.size(), primitives);
  auto sizes = made<VkAccelerationStructureBuildSizesInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR);
  load<PFN_vkGetAccelerationStructureBuildSizesKHR>("vkGetAccelerationStructureBuildSizesKHR")(
      device_, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info, counts.data(), &sizes);
  Structure built;
  built.storage = std::make_unique<Buffer>(*this, sizes.accelerationStructureSize);
  auto create = made<VkAccelerationStructureCreateInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR);
  create.buffer = built.storage->handle();
  create.size = sizes.accelerationStructureSize;
  create.type = type;
  check(load<PFN_vkCreateAccelerationStructureKHR>("vkCreateAccelerationStructureKHR")(
            device_, &create, nullptr, &built.handle),
        "vkCreateAccelerationStructureKHR");
  const Buffer scratch(*this, sizes.buildScratchSize + 256);
  info.dstAccelerationStructure = built.handle;
  info.scratchData.deviceAddress = (scratch.address() + 255) & ~VkDeviceAddress{255};
  const std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges(geometries.size(),
                                                                     {primitives, 0, 0, 0});
  const VkAccelerationStructureBuildRangeInfoKHR* const range = ranges.data();
  submit([&](VkCommandBuffer commands) {
    load<PFN_vkCmdBuildAccelerationStructuresKHR>("vkCmdBuildAccelerationStructuresKHR")(
        commands, 1, &info, &range);
  });
  auto address = made<VkAccelerationStructureDeviceAddressInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR);
  address.accelerationStructure = built.handle;
  built.address = load<PFN_vkGetAccelerationStructureDeviceAddressKHR>(
      "vkGetAccelerationStructureDeviceAddressKHR")(device_, &address);
  return built;
}

void Driver::build_scene() {
  constexpr float kVertices[] = {0, -1, 5, 1, -1, 5, 0.5f, 1, 5, 2, -1, 5, 3, -1, 5, 2.5f, 1, 5};
  constexpr VkAabbPositionsKHR kBox{4, -1, 5, 5, 1, 6};
  kept_.push_back(std::make_unique<Buffer>(*this, sizeof kVertices));
  std::memcpy(kept_.back()->data<void>(), kVertices, sizeof kVertices);
  const auto triangle = [&](std::size_t first, VkGeometryFlagsKHR flags) {
    auto geometry = made<VkAccelerationStructureGeometryKHR>(
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR);
    geometry.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
    geometry.flags = flags;
    auto& triangles = geometry.geometry.triangles;
    triangles.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR;
    triangles.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
    triangles.vertexData.deviceAddress = kept_[0]->address() + first * 12;
    triangles.vertexStride = 12;
    triangles.maxVertex = 2;
    triangles.indexType = VK_INDEX_TYPE_NONE_KHR;
    return geometry;
  };
  const VkAccelerationStructureGeometryKHR triangles[] = {triangle(0, VK_GEOMETRY_OPAQUE_BIT_KHR),
                                                          triangle(3, 0)};
  structures_.push_back(build(VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, triangles, 1));

  kept_.push_back(std::make_unique<Buffer>(*this, sizeof kBox));
  std::memcpy(kept_.back()->data<void>(), &kBox, sizeof kBox);
  auto box = made<VkAccelerationStructureGeometryKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR);
  box.geometryType = VK_GEOMETRY_TYPE_AABBS_KHR;
  box.geometry.aabbs.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_AABBS_DATA_KHR;
  box.geometry.aabbs.data.deviceAddress = kept_.back()->address();
  box.geometry.aabbs.stride = sizeof kBox;
  structures_.push_back(build(VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, {&box, 1}, 1));

  kept_.push_back(std::make_unique<Buffer>(*this, 2 * sizeof(VkAccelerationStructureInstanceKHR)));
  auto* const instances = kept_.back()->data<VkAccelerationStructureInstanceKHR>();
  for (std::uint32_t i = 0; i < 2; ++i) {
    instances[i] = {};
    for (int axis = 0; axis < 3; ++axis) {
      instances[i].transform.matrix[axis][axis] = 1;
    }
    instances[i].instanceCustomIndex = (10 * (i + 1)) & 0xffffffu;
    instances[i].mask = 0xff;
    instances[i].instanceShaderBindingTableRecordOffset = i & 0xffffffu;
    instances[i].accelerationStructureReference = structures_[i].address;
  }
  auto top = made<VkAccelerationStructureGeometryKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR);
  top.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
  top.geometry.instances.sType =
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR;
  top.geometry.instances.data.deviceAddress = kept_.back()->address();
  structures_.push_back(build(VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, {&top, 1}, 2));
}

void Driver::create_descriptors() {
  VkDescriptorSetLayoutBinding binding{};
  binding.descriptorType = VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR;
  binding.descriptorCount = 1;
  binding.stageFlags = VK_SHADER_STAGE_ALL;
  auto layout =
      made<VkDescriptorSetLayoutCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
  layout.bindingCount = 1;
  layout.pBindings = &binding;
  check(vkCreateDescriptorSetLayout(device_, &layout, nullptr, &set_layout_), "set layout");
  auto pipeline = made<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  pipeline.setLayoutCount = 1;
  pipeline.pSetLayouts = &set_layout_;
  check(vkCreatePipelineLayout(device_, &pipeline, nullptr, &layout_), "pipeline layout");
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 1};
  auto pool = made<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  pool.maxSets = 1;
  pool.poolSizeCount = 1;
  pool.pPoolSizes = &size;
  check(vkCreateDescriptorPool(device_, &pool, nullptr, &descriptors_), "descriptor pool");
  auto allocate = made<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  allocate.descriptorPool = descriptors_;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &set_layout_;
  check(vkAllocateDescriptorSets(device_, &allocate, &set_), "descriptor set");
  auto structure = made<VkWriteDescriptorSetAccelerationStructureKHR>(
      VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR);
  structure.accelerationStructureCount = 1;
  structure.pAccelerationStructures = &structures_.back().handle;
  auto write = made<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, &structure);
  write.dstSet = set_;
  write.descriptorCount = 1;
  write.descriptorType = VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR;
  vkUpdateDescriptorSets(device_, 1, &write, 0, nullptr);
}

VkShaderModule Driver::module(const Words& words) {
  auto info = made<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  info.codeSize = words.size() * 4;
  info.pCode = words.data();
  VkShaderModule created = VK_NULL_HANDLE;
  check(vkCreateShaderModule(device_, &info, nullptr, &created), "vkCreateShaderModule");
  return created;
}

VkPipeline Driver::ray_tracing_pipeline(const RayTracingShaders& shaders) {
  std::vector<Words> key;
  for (const auto& stage : shaders.stages) {
    key.push_back(stage.words);
  }
  VkPipeline& pipeline = pipelines_[key];
  if (pipeline != VK_NULL_HANDLE) {
    return pipeline;
  }
  std::vector<VkPipelineShaderStageCreateInfo> stages;
  for (const auto& stage : shaders.stages) {
    auto info =
        made<VkPipelineShaderStageCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
    info.stage = stage.stage;
    info.module = module(stage.words);
    info.pName = "main";
    stages.push_back(info);
  }
  auto none = made<VkRayTracingShaderGroupCreateInfoKHR>(
      VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR);
  none.type = VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR;
  none.generalShader = none.closestHitShader = none.anyHitShader = none.intersectionShader =
      VK_SHADER_UNUSED_KHR;
  std::vector<VkRayTracingShaderGroupCreateInfoKHR> groups(2, none);
  groups[1].generalShader = 1;
  groups[0].generalShader = 0;
  for (const HitGroup& hit : shaders.hits) {
    groups.push_back(none);
    groups.back().type = hit.type;
    groups.back().closestHitShader = hit.closest_hit;
    groups.back().anyHitShader = hit.any_hit;
    groups.back().intersectionShader = hit.intersection;
  }
  auto info = made<VkRayTracingPipelineCreateInfoKHR>(
      VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR);
  info.stageCount = static_cast<std::uint32_t>(stages.size());
  info.pStages = stages.data();
  info.groupCount = static_cast<std::uint32_t>(groups.size());
  info.pGroups = groups.data();
  info.maxPipelineRayRecursionDepth = 4;
  info.layout = layout_;
  check(load<PFN_vkCreateRayTracingPipelinesKHR>("vkCreateRayTracingPipelinesKHR")(
            device_, VK_NULL_HANDLE, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
        "vkCreateRayTracingPipelinesKHR");
  for (const auto& stage : stages) {
    vkDestroyShaderModule(device_, stage.module, nullptr);
  }
  return pipeline;
}

void Driver::trace(const RayTracingShaders& shaders, std::uint32_t width, std::uint32_t height) {
  const VkPipeline pipeline = ray_tracing_pipeline(shaders);
  const std::size_t groups = 2 + shaders.hits.size();
  // One table; every group at a multiple of the base alignment, so that any may start a region.
  const VkDeviceSize stride = limits_.shaderGroupBaseAlignment;
  const std::uint32_t handle = limits_.shaderGroupHandleSize;
  std::vector<std::uint8_t> handles(groups * handle);
  check(
      load<PFN_vkGetRayTracingShaderGroupHandlesKHR>("vkGetRayTracingShaderGroupHandlesKHR")(
          device_, pipeline, 0, static_cast<std::uint32_t>(groups), handles.size(), handles.data()),
      "vkGetRayTracingShaderGroupHandlesKHR");
  const Buffer table(*this, stride * (groups + 1));
  const VkDeviceAddress start = (table.address() + stride - 1) / stride * stride;
  for (std::size_t g = 0; g < groups; ++g) {
    std::memcpy(table.data<std::uint8_t>() + (start - table.address()) + g * stride,
                handles.data() + g * handle, handle);
  }
  const VkStridedDeviceAddressRegionKHR raygen{start, stride, stride};
  const VkStridedDeviceAddressRegionKHR miss{start + stride, stride, stride};
  const VkStridedDeviceAddressRegionKHR hit{start + 2 * stride, stride,
                                            stride * shaders.hits.size()};
  const VkStridedDeviceAddressRegionKHR callable{};
  submit([&](VkCommandBuffer commands) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, pipeline);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, layout_, 0, 1, &set_,
                            0, nullptr);
    load<PFN_vkCmdTraceRaysKHR>("vkCmdTraceRaysKHR")(commands, &raygen, &miss, &hit, &callable,
                                                     width, height, 1);
  });
}

VkPipeline Driver::compute_pipeline(const Words& compute) {
  VkPipeline& pipeline = pipelines_[{compute}];
  if (pipeline != VK_NULL_HANDLE) {
    return pipeline;
  }
  auto info = made<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module(compute);
  info.stage.pName = "main";
  info.layout = layout_;
  check(vkCreateComputePipelines(device_, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
        "vkCreateComputePipelines");
  vkDestroyShaderModule(device_, info.stage.module, nullptr);
  return pipeline;
}

void Driver::dispatch(const Words& compute, std::uint32_t groups_x, std::uint32_t groups_y) {
  const VkPipeline pipeline = compute_pipeline(compute);
  submit([&](VkCommandBuffer commands) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0, 1, &set_, 0,
                            nullptr);
    vkCmdDispatch(commands, groups_x, groups_y, 1);
  });
}

Driver::~Driver() {
  if (device_ != VK_NULL_HANDLE) {
    const auto destroy =
        load<PFN_vkDestroyAccelerationStructureKHR>("vkDestroyAccelerationStructureKHR");
    for (const Structure& structure : structures_) {
      destroy(device_, structure.handle, nullptr);
    }
    structures_.clear();
    kept_.clear();
    for (const auto& [words, pipeline] : pipelines_) {
      vkDestroyPipeline(device_, pipeline, nullptr);
    }
    vkDestroyDescriptorPool(device_, descriptors_, nullptr);
    vkDestroyPipelineLayout(device_, layout_, nullptr);
    vkDestroyDescriptorSetLayout(device_, set_layout_, nullptr);
    vkDestroyCommandPool(device_, pool_, nullptr);
    vkDestroyDevice(device_, nullptr);
  }
  if (instance_ != VK_NULL_HANDLE) {
    vkDestroyInstance(instance_, nullptr);
  }
}

}  // namespace a2rt::spirv::testing
