#include "layer/device.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "layer/log.h"

namespace a2rt::layer {
namespace {

std::string command_line_of_process() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::replace(text.begin(), text.end(), '\0', ' ');
  return text;
}

// Threads for a rebuild: the driver waits meanwhile, so its cores are free.
unsigned rebuild_threads() { return std::clamp(std::thread::hardware_concurrency(), 1u, 8u); }

}  // namespace

Device::Device(const DeviceSetup& setup)
    : setup_(setup),
      session_(setup.settings.instrumenting() ? std::make_unique<Session>(setup.settings)
                                              : nullptr),
      structure_writer_(structures_, manifest(), {setup.settings.rebuild, rebuild_threads()}) {
  if (watches_builds()) {
    callbacks_ = std::make_unique<HostCallbacks>(setup_.table, setup_.device, setup_.memory);
  }
  if (session_ != nullptr) {
    create_epilogue();
  }
  write_driver_block();
}

Device::~Device() {
  finish(false);
  callbacks_.reset();
  if (epilogue_pool_ != VK_NULL_HANDLE) {
    setup_.table.DestroyCommandPool(setup_.device, epilogue_pool_, nullptr);
  }
}

void Device::write_driver_block() {
  if (manifest() == nullptr) {
    return;
  }
  capture::DriverBlock block{};
  block.vendor_id = setup_.driver.properties.vendorID;
  block.device_id = setup_.driver.properties.deviceID;
  block.driver_id = setup_.driver.driver_id;
  block.driver_version = setup_.driver.properties.driverVersion;
  block.tree_rebuilt = setup_.settings.rebuild ? 1 : 0;
  const auto device = encode_string(setup_.driver.properties.deviceName);
  const auto name = encode_string(setup_.driver.driver_name);
  const auto info_text = encode_string(setup_.driver.driver_info);
  const auto command = encode_string(command_line_of_process());
  manifest()->write(capture::BlockType::kDriver, {bytes_of(block), bytes_of(device), bytes_of(name),
                                                  bytes_of(info_text), bytes_of(command)});
}

// One command buffer of the layer's own: its host callback marks the end of a submit.
void Device::create_epilogue() {
  VkCommandPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool.queueFamilyIndex = setup_.queue_family;
  VkCommandBufferAllocateInfo allocation{};
  allocation.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  allocation.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocation.commandBufferCount = 1;
  VkCommandBufferBeginInfo begin{};
  begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  begin.flags = VK_COMMAND_BUFFER_USAGE_SIMULTANEOUS_USE_BIT;
  const DeviceTable& table = setup_.table;
  bool good = table.CreateCommandPool(setup_.device, &pool, nullptr, &epilogue_pool_) == VK_SUCCESS;
  allocation.commandPool = epilogue_pool_;
  good = good && table.AllocateCommandBuffers(setup_.device, &allocation, &epilogue_) == VK_SUCCESS;
  if (!good) {
    throw std::runtime_error("the driver refused the layer's own command buffer");
  }
  // The loader, which normally does this, never sees the command buffer.
  *reinterpret_cast<void**>(epilogue_) = *reinterpret_cast<void**>(setup_.device);
  const std::uint64_t id = callbacks_->add([this] { session_->quiesce(); });
  table.BeginCommandBuffer(epilogue_, &begin);
  callbacks_->record(epilogue_, id);
  table.EndCommandBuffer(epilogue_);
}

void Device::refuse_once(const std::string& what) {
  {
    const std::lock_guard lock(mutex_);
    if (std::find(refused_.begin(), refused_.end(), what) != refused_.end()) {
      return;
    }
    refused_.push_back(what);
  }
  if (manifest() != nullptr) {
    manifest()->refuse(what);
  } else {
    info(what);
  }
}

void Device::dump(std::span<const std::uint32_t> words, std::uint32_t shader,
                  const char* suffix) const {
  if (setup_.settings.dump_directory.empty()) {
    return;
  }
  const auto path = std::filesystem::path(setup_.settings.dump_directory) /
                    ("shader" + std::to_string(shader) + suffix);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(words.data()),
             static_cast<std::streamsize>(words.size_bytes()));
  if (!file) {
    warn("cannot write " + path.string());
  }
}

Device::Module Device::instrument(std::span<const std::uint32_t> words) {
  if (session_ == nullptr) {
    return {};
  }
  // Indices of one module are consecutive and their number is known afterwards.
  const std::lock_guard lock(instrument_mutex_);
  try {
    const auto first = shaders_.reserve_indices(0);
    auto result = spirv::instrument(words, session_->instrument_options(*first));
    for (const std::string& warning : result.analysis.warnings) {
      debug("shader: " + warning);
    }
    if (!result.instrumented) {
      if (result.analysis.has_rays()) {
        refuse_once("a shader module traces rays in a way that is not captured (shader hash " +
                    std::to_string(hash_words(words)) + ")");
      }
      return {};
    }
    if (!shaders_.reserve_indices(result.shader_count)) {
      refuse_once("the program has more than 65536 ray-tracing shaders; the rest is not captured");
      return {};
    }
    dump(words, *first, ".original.spv");
    dump(result.words, *first, ".instrumented.spv");
    if (manifest() != nullptr) {
      for (const spirv::EntryPoint& entry : result.analysis.entry_points) {
        if (!entry.instrumented) {
          continue;
        }
        const capture::ShaderBlock block{entry.shader, static_cast<std::uint32_t>(entry.stage),
                                         hash_words(words), 1,
                                         static_cast<std::uint32_t>(entry.sites.size())};
        const auto name = encode_string(entry.name);
        manifest()->write(capture::BlockType::kShader, {bytes_of(block), bytes_of(name)});
      }
    }
    auto state = std::make_shared<ModuleState>();
    state->words.assign(words.begin(), words.end());
    state->analysis = std::move(result.analysis);
    return {std::move(result.words), std::move(state)};
  } catch (const std::exception& error) {
    refuse_once(std::string("a shader cannot be instrumented and runs as it is: ") + error.what());
    return {};
  }
}

std::vector<std::uint32_t> Device::instrument_late(const ModuleState& module) const {
  const auto& entries = module.analysis.entry_points;
  const auto first = std::find_if(entries.begin(), entries.end(),
                                  [](const auto& entry) { return entry.instrumented; });
  spirv::InstrumentOptions options = session_->instrument_options(first->shader);
  options.early_tests = false;
  return spirv::instrument(module.words, options).words;
}

void Device::announce(const PipelineState& pipeline) {
  if (manifest() == nullptr) {
    return;
  }
  for (const StageState& stage : pipeline.stages) {
    if (stage.shader == capture::kUnused) {
      continue;
    }
    std::vector<capture::SiteBlock> sites;
    for (const spirv::TraceSite& site : stage.sites) {
      const auto structure = site.structure.kind == spirv::StructureSource::Kind::kDescriptor ? 1u
                             : site.structure.kind == spirv::StructureSource::Kind::kAddress  ? 2u
                                                                                              : 0u;
      sites.push_back({site.site, site.is_query ? 1u : 0u, site.ray_flags ? 1u : 0u,
                       site.ray_flags.value_or(0), site.cull_mask ? 1u : 0u,
                       site.cull_mask.value_or(0), structure, site.structure.set,
                       site.structure.binding});
    }
    const capture::EffectsBlock block{stage.shader, stage.effects,
                                      static_cast<std::uint32_t>(sites.size()), 0};
    manifest()->write(capture::BlockType::kEffects, {bytes_of(block), bytes_of(sites)});
  }
  std::vector<std::uint32_t> shaders;
  for (const StageState& stage : pipeline.stages) {
    shaders.push_back(stage.shader);
  }
  const capture::PipelineBlock block{pipeline.index,
                                     static_cast<std::uint32_t>(pipeline.stages.size()),
                                     static_cast<std::uint32_t>(pipeline.groups.size()),
                                     pipeline.max_recursion,
                                     static_cast<std::uint32_t>(pipeline.kind),
                                     0};
  manifest()->write(capture::BlockType::kPipeline,
                    {bytes_of(block), bytes_of(shaders), bytes_of(pipeline.groups)});
}

void Device::add_callback(VkCommandBuffer commands, HostCallbacks::Callback callback) {
  const std::uint64_t id = callbacks_->add(std::move(callback));
  callbacks_->record(commands, id);
  const auto state = commands_.find(commands);
  state->callbacks.push_back(id);
  ++state->callback_count;
}

void Device::forget_callbacks(const std::vector<std::uint64_t>& ids) {
  for (const std::uint64_t id : ids) {
    callbacks_->remove(id);
  }
}

std::uint64_t Device::resolve(const spirv::StructureSource& source, const BoundSets& sets) const {
  if (source.kind != spirv::StructureSource::Kind::kDescriptor) {
    return 0;
  }
  if (source.is_array && !source.element) {
    return 0;
  }
  const auto bound = sets.find(source.set);
  if (bound == sets.end()) {
    return 0;
  }
  const DescriptorSlot slot{source.binding, source.element.value_or(0)};
  std::optional<VkAccelerationStructureKHR> structure;
  if (bound->second.set != VK_NULL_HANDLE) {
    structure = descriptors_.find(bound->second.set, slot);
  } else if (const auto pushed = bound->second.pushed.find(slot);
             pushed != bound->second.pushed.end()) {
    structure = pushed->second;
  }
  const auto built =
      structure ? structures_.at(structures_.address(*structure)) : std::optional<BuiltStructure>{};
  return built ? built->id : 0;
}

std::vector<capture::SiteBinding> Device::resolve_sites(std::span<const BoundWork> works) {
  std::vector<capture::SiteBinding> bindings;
  for (const BoundWork& work : works) {
    for (const StageState& stage : work.pipeline->stages) {
      for (const spirv::TraceSite& site : stage.sites) {
        const capture::SiteBinding binding{stage.shader, site.site,
                                           resolve(site.structure, work.sets)};
        const auto same = std::find_if(bindings.begin(), bindings.end(), [&](const auto& other) {
          return other.shader == binding.shader && other.site == binding.site;
        });
        if (same == bindings.end()) {
          bindings.push_back(binding);
        } else if (same->tlas_id != binding.tlas_id) {
          same->tlas_id = 0;
          refuse_once("draws of one render pass trace different structures with one shader");
        }
      }
    }
  }
  const bool unknown = std::any_of(bindings.begin(), bindings.end(),
                                   [](const auto& binding) { return binding.tlas_id == 0; });
  if (unknown && manifest() != nullptr) {
    refuse_once(
        "the acceleration structure of a trace instruction is unknown (not a plain descriptor, or "
        "never built)");
  }
  return bindings;
}

void Device::warn_about_order(std::span<const BoundWork> works) {
  if (!setup_.settings.rebuild || !structures_.any_non_opaque()) {
    return;
  }
  const bool depends = std::any_of(works.begin(), works.end(), [](const BoundWork& work) {
    return work.pipeline->any_hit_may_depend_on_order;
  });
  const std::lock_guard lock(mutex_);
  if (depends && !order_warned_) {
    order_warned_ = true;
    warn(
        "the program has any-hit shaders whose results may depend on the order of traversal, which "
        "the rebuilt tree changes; set A2RT_REBUILD=off for the driver's own order");
  }
}

std::uint32_t Device::next_frame() {
  const std::lock_guard lock(mutex_);
  while (!frames_ahead_.empty() && frames_ahead_.front() == 0) {
    frames_ahead_.pop_front();
    ++frame_;
  }
  if (!frames_ahead_.empty()) {
    --frames_ahead_.front();
  }
  return frame_;
}

void Device::begin_work(PipelineState::Kind kind, Extent size, std::span<const BoundWork> works) {
  warn_about_order(works);
  capture::DispatchBlock block{};
  block.frame = next_frame();
  block.width = size[0];
  block.height = size[1];
  block.depth = size[2];
  block.kind = static_cast<std::uint32_t>(kind);
  block.pipeline = works.front().pipeline->index;
  const auto bindings = resolve_sites(works);
  block.site_count = static_cast<std::uint32_t>(bindings.size());
  session_->begin_dispatch(block, bindings);
}

Device::SubmitCount Device::count(std::span<const VkCommandBuffer> buffers) {
  SubmitCount total;
  for (const VkCommandBuffer buffer : buffers) {
    const auto state = commands_.find(buffer);
    total.callbacks += state->callback_count;
    total.traced += state->traced_work();
  }
  return total;
}

VkCommandBuffer Device::before_submit(std::span<const VkCommandBuffer> buffers) {
  if (callbacks_ == nullptr) {
    return VK_NULL_HANDLE;
  }
  const SubmitCount total = count(buffers);
  const bool append = total.traced != 0 && epilogue_ != VK_NULL_HANDLE;
  if (total.traced != 0) {
    const std::lock_guard lock(mutex_);
    frames_ahead_.push_back(total.traced);
  }
  if (total.callbacks != 0 || append) {
    callbacks_->expect(total.callbacks + (append ? 1 : 0));
  }
  return append ? epilogue_ : VK_NULL_HANDLE;
}

void Device::submit_failed(std::span<const VkCommandBuffer> buffers, bool appended) {
  if (callbacks_ == nullptr) {
    return;
  }
  const SubmitCount total = count(buffers);
  if (total.traced != 0) {
    const std::lock_guard lock(mutex_);
    frames_ahead_.pop_back();
  }
  callbacks_->unexpect(total.callbacks + (appended ? 1 : 0));
}

void Device::finish(bool exiting) {
  if (callbacks_ == nullptr || session_ == nullptr) {
    return;
  }
  const bool running = callbacks_->pending() != 0;
  callbacks_->stop();
  if (running) {
    session_->abandon(exiting ? "the program ended while the device was still tracing"
                              : "the program destroyed the device while it was still tracing");
    return;
  }
  session_->finish();
}

}  // namespace a2rt::layer
