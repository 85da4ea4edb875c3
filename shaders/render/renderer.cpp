#include "render/renderer.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <ctime>

#include "a2rt/base/error.h"
#include "render/spirv.h"

namespace a2rt::render {
namespace {

constexpr VkBufferUsageFlags kTable = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
constexpr VkBufferUsageFlags kBuildInput =
    kTable | VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  double cpu_seconds() const {
    return static_cast<double>(std::clock() - cpu_start_) / CLOCKS_PER_SEC;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::clock_t cpu_start_ = std::clock();
};

VkSamplerAddressMode address_mode(scene::Wrap wrap) {
  switch (wrap) {
    case scene::Wrap::kClamp:
      return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    case scene::Wrap::kMirror:
      return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
    case scene::Wrap::kRepeat:
      break;
  }
  return VK_SAMPLER_ADDRESS_MODE_REPEAT;
}

VkTransformMatrixKHR rows(const glm::mat4& m) {
  VkTransformMatrixKHR t{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      t.matrix[row][column] = m[column][row];
    }
  }
  return t;
}

}  // namespace

double Timings::median_frame() const {
  if (frames.empty()) {
    return 0;
  }
  std::vector<double> sorted = frames;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t half = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
}

Renderer::Renderer(const vulkan::Context& context, const scene::Scene& scene,
                   const scene::Camera& camera, const workloads::WorkloadConfig& workload,
                   const effects::Choice& choice, const Settings& settings)
    : context_(context),
      choice_(choice),
      settings_(settings),
      packed_(pack(scene, choice, workload.opaque_geometry)),
      frame_(make_frame(scene, camera, workload, settings)) {
  if (packed_.instances.empty()) {
    throw UserError("scene '" + scene.name + "': nothing is left to draw with these effects");
  }
  frame_.cull = choice.uses(gpu::kEffectCulling) ? 1 : 0;
  frame_.light_count = static_cast<std::uint32_t>(packed_.lights.size());
  frame_.emitter_count = static_cast<std::uint32_t>(packed_.emitters.size());
  upload(scene);
  const Stopwatch build;
  build_structures();
  timings_.build = build.seconds();
  const Stopwatch compile;
  build_pipeline(workload);
  timings_.pipeline = compile.seconds();
  timings_.pipeline_cpu = compile.cpu_seconds();
  write_descriptors();
}

void Renderer::upload(const scene::Scene& scene) {
  const auto table = [&](const auto& data, VkBufferUsageFlags usage) {
    using Element = typename std::decay_t<decltype(data)>::value_type;
    return vulkan::Buffer::of<Element>(context_, data, usage);
  };
  vertices_ = table(packed_.vertices, kBuildInput);
  indices_ = table(packed_.indices, kBuildInput);
  geometries_ = table(packed_.geometries, kTable);
  materials_ = table(packed_.materials, kTable);
  shapes_ = table(packed_.shapes, kTable);
  lights_ = table(packed_.lights, kTable);
  emitters_ = table(packed_.emitters, kTable);
  counts_ = table(std::vector<std::uint32_t>(gpu::kRayKinds, 0), kTable);
  uniforms_ = vulkan::Buffer(context_, sizeof(gpu::Frame), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
  accumulation_ =
      vulkan::Image(context_, settings_.width, settings_.height, VK_FORMAT_R32G32B32A32_SFLOAT,
                    VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
  picture_ = vulkan::Image(context_, settings_.width, settings_.height, VK_FORMAT_R8G8B8A8_UNORM,
                           VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
  context_.run([&](VkCommandBuffer commands) {
    accumulation_.transition(commands, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
    picture_.transition(commands, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
  });
  // A table of textures has at least one entry; nobody samples it if the scene has none.
  const std::vector<scene::Texture> none(1);
  const bool textured =
      choice_.has(gpu::kEffectTextures | gpu::kEffectNormalMaps) && !scene.textures.empty();
  for (const scene::Texture& t : textured ? scene.textures : none) {
    textures_.emplace_back(context_, t.width, t.height,
                           t.srgb ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM,
                           VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT);
    textures_.back().upload(context_, t.rgba);
    samplers_.emplace_back(context_,
                           vulkan::SamplerOptions{t.nearest ? VK_FILTER_NEAREST : VK_FILTER_LINEAR,
                                                  address_mode(t.wrap_u), address_mode(t.wrap_v)});
  }
}

void Renderer::build_bottom_level() {
  for (const PackedBlas& blas : packed_.blas) {
    if (blas.procedural) {
      const std::uint32_t first = packed_.geometries[blas.first_geometry].first_index;
      std::vector<VkAabbPositionsKHR> boxes;
      for (std::uint32_t i = 0; i < packed_.ranges[blas.first_geometry].triangle_count; ++i) {
        const gpu::Shape& s = packed_.shapes[first + i];
        const glm::vec3 lo = s.centre - s.half_extent;
        const glm::vec3 hi = s.centre + s.half_extent;
        boxes.push_back({lo.x, lo.y, lo.z, hi.x, hi.y, hi.z});
      }
      const auto input = vulkan::Buffer::of<VkAabbPositionsKHR>(context_, boxes, kBuildInput);
      bottom_.push_back(vulkan::AccelerationStructure::of_boxes(
          context_, {input.address(), static_cast<std::uint32_t>(boxes.size())}));
      continue;
    }
    std::vector<vulkan::TriangleGeometry> geometries;
    for (std::uint32_t i = 0; i < blas.geometry_count; ++i) {
      const gpu::Geometry& g = packed_.geometries[blas.first_geometry + i];
      const PackedRange& range = packed_.ranges[blas.first_geometry + i];
      geometries.push_back(
          {vertices_.address() + std::uint64_t{g.first_vertex} * sizeof(gpu::Vertex),
           sizeof(gpu::Vertex), range.vertex_count,
           indices_.address() + std::uint64_t{g.first_index} * 4, range.triangle_count,
           range.opaque});
    }
    bottom_.push_back(geometries.empty()
                          ? vulkan::AccelerationStructure{}
                          : vulkan::AccelerationStructure::of_triangles(context_, geometries));
  }
}

void Renderer::build_structures() {
  build_bottom_level();
  std::vector<VkAccelerationStructureInstanceKHR> instances;
  for (const PackedInstance& p : packed_.instances) {
    const PackedBlas& blas = packed_.blas[p.blas];
    VkAccelerationStructureInstanceKHR instance{};
    instance.transform = rows(p.transform);
    instance.instanceCustomIndex = blas.first_geometry & 0xffffffU;
    instance.mask = 0xff;
    // Hit records: 0 triangles, 1 spheres, 2 boxes.
    const std::uint32_t record = !blas.procedural                               ? 0U
                                 : blas.shape_kind == scene::ShapeKind::kSphere ? 1U
                                                                                : 2U;
    instance.instanceShaderBindingTableRecordOffset = record & 0xffffffU;
    // Fronts are those of glTF, and an instance's transform does not change them.
    instance.flags = 0;
    if (!p.culled) {
      instance.flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR;
    }
    instance.accelerationStructureReference = bottom_[p.blas].address();
    instances.push_back(instance);
  }
  A2RT_CHECK(packed_.geometries.size() < (1U << 24U), "more geometries than a custom index holds");
  top_ = vulkan::AccelerationStructure::of_instances(context_, instances);
}

void Renderer::build_pipeline(const workloads::WorkloadConfig& workload) {
  vulkan::PipelineDescription d;
  VkShaderStageFlags used = 0;
  const auto stage = [&](const std::string& file, VkShaderStageFlagBits bit) {
    d.stages.push_back({bit, spirv(file)});
    stage_files_.push_back(file);
    used |= static_cast<VkShaderStageFlags>(bit);
    return static_cast<std::uint32_t>(d.stages.size() - 1);
  };
  // A shader that the workload's file names under `key`.
  const auto named = [&](const char* key, const std::string& file, VkShaderStageFlagBits bit) {
    const auto place = workload.stage_places.find(key);
    try {
      return stage(file, bit);
    } catch (const UserError& e) {
      throw UserError(place == workload.stage_places.end() ? std::string(e.what())
                                                           : place->second + ": " + e.what());
    }
  };
  d.ray_generation =
      named("ray_generation", workload.ray_generation + ".rgen", VK_SHADER_STAGE_RAYGEN_BIT_KHR);
  for (const std::string& miss : workload.misses) {
    const bool for_shadows = miss == "shadow";
    const std::uint32_t shadows =
        gpu::kEffectShadow | gpu::kEffectSoftShadow | gpu::kEffectAmbientOcclusion;
    if (!for_shadows || (choice_.has(shadows) && !settings_.lumibench_shadow)) {
      d.misses.push_back(named("misses", miss + ".rmiss", VK_SHADER_STAGE_MISS_BIT_KHR));
    }
  }
  vulkan::HitGroup triangles;
  triangles.closest_hit = named("triangle_closest_hit", workload.triangle_closest_hit + ".rchit",
                                VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR);
  if (choice_.has(gpu::kEffectAlpha)) {
    triangles.any_hit = stage("alpha.rahit", VK_SHADER_STAGE_ANY_HIT_BIT_KHR);
  }
  d.hit_groups.push_back(triangles);
  if (choice_.has(gpu::kEffectProcedural)) {
    const std::uint32_t closest = named("shape_closest_hit", workload.shape_closest_hit + ".rchit",
                                        VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR);
    for (const char* file : {"sphere.rint", "box.rint"}) {
      vulkan::HitGroup shape;
      shape.closest_hit = closest;
      shape.intersection = stage(file, VK_SHADER_STAGE_INTERSECTION_BIT_KHR);
      d.hit_groups.push_back(shape);
    }
  }
  for (std::uint32_t binding = 0; binding < gpu::kBindings; ++binding) {
    VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    std::uint32_t count = 1;
    if (binding == gpu::kBindTlas) {
      type = VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR;
    } else if (binding == gpu::kBindAccumulation || binding == gpu::kBindPicture) {
      type = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
    } else if (binding == gpu::kBindFrame) {
      type = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    } else if (binding == gpu::kBindTextures) {
      type = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
      count = static_cast<std::uint32_t>(textures_.size());
    }
    d.bindings.push_back({binding, type, count, used, nullptr});
  }
  d.constants = {choice_.built, settings_.count_rays ? 1U : 0U,
                 settings_.lumibench_shadow ? 1U : 0U};
  d.recursion = workload.recursion;
  pipeline_ = std::make_unique<vulkan::Pipeline>(context_, d);
}

void Renderer::write_descriptors() {
  const std::vector<VkDescriptorPoolSize> sizes = {
      {VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 1},
      {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 2},
      {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1},
      {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, gpu::kBindings},
      {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, static_cast<std::uint32_t>(textures_.size())}};
  VkDescriptorPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  pool.maxSets = 1;
  pool.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
  pool.pPoolSizes = sizes.data();
  VkDescriptorPool made = VK_NULL_HANDLE;
  vulkan::check(vkCreateDescriptorPool(context_.device(), &pool, nullptr, &made),
                "vkCreateDescriptorPool");
  pool_ = std::unique_ptr<std::remove_pointer_t<VkDescriptorPool>, PoolDeleter>(
      made, PoolDeleter{context_.device()});
  VkDescriptorSetLayout layout = pipeline_->set_layout();
  VkDescriptorSetAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  allocate.descriptorPool = made;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &layout;
  vulkan::check(vkAllocateDescriptorSets(context_.device(), &allocate, &set_),
                "vkAllocateDescriptorSets");

  const auto write = [&](std::uint32_t binding, VkDescriptorType type) {
    VkWriteDescriptorSet w{};
    w.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    w.dstSet = set_;
    w.dstBinding = binding;
    w.descriptorCount = 1;
    w.descriptorType = type;
    return w;
  };
  VkWriteDescriptorSetAccelerationStructureKHR structure{};
  structure.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR;
  structure.accelerationStructureCount = 1;
  const VkAccelerationStructureKHR top = top_.handle();
  structure.pAccelerationStructures = &top;
  VkWriteDescriptorSet tlas = write(gpu::kBindTlas, VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR);
  tlas.pNext = &structure;
  vkUpdateDescriptorSets(context_.device(), 1, &tlas, 0, nullptr);

  const auto write_buffer = [&](std::uint32_t binding, const vulkan::Buffer& buffer,
                                VkDescriptorType type) {
    const VkDescriptorBufferInfo info{buffer.handle(), 0, VK_WHOLE_SIZE};
    VkWriteDescriptorSet w = write(binding, type);
    w.pBufferInfo = &info;
    vkUpdateDescriptorSets(context_.device(), 1, &w, 0, nullptr);
  };
  write_buffer(gpu::kBindFrame, uniforms_, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER);
  const std::pair<std::uint32_t, const vulkan::Buffer*> tables[] = {
      {gpu::kBindVertices, &vertices_},     {gpu::kBindIndices, &indices_},
      {gpu::kBindGeometries, &geometries_}, {gpu::kBindMaterials, &materials_},
      {gpu::kBindShapes, &shapes_},         {gpu::kBindLights, &lights_},
      {gpu::kBindEmitters, &emitters_},     {gpu::kBindRayCounts, &counts_}};
  for (const auto& [binding, buffer] : tables) {
    write_buffer(binding, *buffer, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
  }
  std::vector<VkDescriptorImageInfo> images = {
      {VK_NULL_HANDLE, accumulation_.view(), VK_IMAGE_LAYOUT_GENERAL},
      {VK_NULL_HANDLE, picture_.view(), VK_IMAGE_LAYOUT_GENERAL}};
  for (std::size_t i = 0; i < textures_.size(); ++i) {
    images.push_back(
        {samplers_[i].handle(), textures_[i].view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL});
  }
  VkWriteDescriptorSet sum = write(gpu::kBindAccumulation, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE);
  sum.pImageInfo = &images[0];
  VkWriteDescriptorSet target = write(gpu::kBindPicture, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE);
  target.pImageInfo = &images[1];
  VkWriteDescriptorSet sampled =
      write(gpu::kBindTextures, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER);
  sampled.descriptorCount = static_cast<std::uint32_t>(textures_.size());
  sampled.pImageInfo = &images[2];
  const VkWriteDescriptorSet writes[] = {sum, target, sampled};
  vkUpdateDescriptorSets(context_.device(), 3, writes, 0, nullptr);
}

void Renderer::dispatch(std::uint32_t first_sample, std::uint32_t samples) {
  frame_.first_sample = first_sample;
  frame_.samples = samples;
  uniforms_.write(&frame_, sizeof frame_);
  std::memset(counts_.mapped(), 0, gpu::kRayKinds * sizeof(std::uint32_t));
  context_.run([&](VkCommandBuffer commands) {
    pipeline_->trace(commands, set_, settings_.width, settings_.height);
  });
  const auto* counted = static_cast<const std::uint32_t*>(counts_.mapped());
  for (std::size_t i = 0; i < total_rays_.size(); ++i) {
    total_rays_[i] += counted[i];
  }
}

Picture Renderer::render(std::uint32_t samples_per_dispatch, const Progress& progress) {
  // Beyond this many samples a dispatch takes long enough to want a progress line.
  constexpr std::uint64_t kLongDispatch = std::uint64_t{1} << 22U;
  const std::uint64_t pixels = std::uint64_t{settings_.width} * settings_.height;
  std::uint32_t step = samples_per_dispatch;
  if (step == 0) {
    step = static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(kLongDispatch / pixels, 1, settings_.samples));
  }
  const std::uint64_t all = std::uint64_t{settings_.samples} * settings_.frames;
  A2RT_CHECK(all <= UINT32_MAX, "more samples than the shaders can number");
  for (std::uint32_t frame = 0; frame < settings_.frames; ++frame) {
    const Stopwatch watch;
    const std::uint32_t base = frame * settings_.samples;
    for (std::uint32_t done = 0; done < settings_.samples; done += step) {
      dispatch(base + done, std::min(step, settings_.samples - done));
      if (progress) {
        progress(std::uint64_t{base} + std::min(done + step, settings_.samples), all);
      }
    }
    timings_.frames.push_back(watch.seconds());
    timings_.frames_cpu.push_back(watch.cpu_seconds());
  }
  return read_back();
}

void Renderer::measure(std::uint32_t repeats) {
  timings_.frames.clear();
  for (std::uint32_t i = 0; i < repeats; ++i) {
    const Stopwatch watch;
    dispatch(0, settings_.samples);
    timings_.frames.push_back(watch.seconds());
  }
  total_rays_ = {};
}

Picture Renderer::read_back() {
  Picture p;
  p.width = settings_.width;
  p.height = settings_.height;
  const std::size_t pixels = std::size_t{p.width} * p.height;
  const vulkan::Buffer sums(context_, pixels * 16, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
  const vulkan::Buffer bytes(context_, pixels * 4, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
  context_.run([&](VkCommandBuffer commands) {
    accumulation_.read_back(commands, sums);
    picture_.read_back(commands, bytes);
  });
  const auto* rgba = static_cast<const std::uint8_t*>(bytes.mapped());
  p.rgba.assign(rgba, rgba + pixels * 4);
  const auto* sum = static_cast<const float*>(sums.mapped());
  const float samples = static_cast<float>(frame_.first_sample + frame_.samples);
  p.rgb.reserve(pixels * 3);
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      p.rgb.push_back(sum[i * 4 + c] / samples);
    }
  }
  return p;
}

std::array<std::uint64_t, gpu::kRayKinds> Renderer::ray_counts() const { return total_rays_; }

std::uint64_t Renderer::structure_bytes() const {
  std::uint64_t bytes = top_.bytes();
  for (const auto& structure : bottom_) {
    bytes += structure.bytes();
  }
  return bytes;
}

}  // namespace a2rt::render
