#include "state/descriptors.h"

#include <cstring>

namespace a2rt::layer {
namespace {

template <class T>
const T* find_in_chain(const void* chain, VkStructureType type) {
  for (auto* item = static_cast<const VkBaseInStructure*>(chain); item != nullptr;
       item = item->pNext) {
    if (item->sType == type) {
      return reinterpret_cast<const T*>(item);
    }
  }
  return nullptr;
}

}  // namespace

void Descriptors::layout_created(VkDescriptorSetLayout layout,
                                 const VkDescriptorSetLayoutCreateInfo& info) {
  auto bindings = std::make_shared<Layout>();
  for (std::uint32_t i = 0; i < info.bindingCount; ++i) {
    (*bindings)[info.pBindings[i].binding] = info.pBindings[i].descriptorCount;
  }
  const std::lock_guard lock(mutex_);
  layouts_[layout] = std::move(bindings);
}

void Descriptors::layout_destroyed(VkDescriptorSetLayout layout) {
  const std::lock_guard lock(mutex_);
  layouts_.erase(layout);
}

void Descriptors::template_created(VkDescriptorUpdateTemplate handle,
                                   const VkDescriptorUpdateTemplateCreateInfo& info) {
  const std::lock_guard lock(mutex_);
  Template& kept = templates_[handle];
  kept.bind_point = info.pipelineBindPoint;
  kept.entries.assign(info.pDescriptorUpdateEntries,
                      info.pDescriptorUpdateEntries + info.descriptorUpdateEntryCount);
}

std::optional<VkPipelineBindPoint> Descriptors::bind_point(
    VkDescriptorUpdateTemplate handle) const {
  const std::lock_guard lock(mutex_);
  const auto found = templates_.find(handle);
  if (found == templates_.end()) {
    return std::nullopt;
  }
  return found->second.bind_point;
}

void Descriptors::template_destroyed(VkDescriptorUpdateTemplate handle) {
  const std::lock_guard lock(mutex_);
  templates_.erase(handle);
}

void Descriptors::allocated(const VkDescriptorSetAllocateInfo& info,
                            std::span<const VkDescriptorSet> sets) {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const auto layout = layouts_.find(info.pSetLayouts[i]);
    sets_[sets[i]] = {info.descriptorPool, layout == layouts_.end() ? nullptr : layout->second, {}};
  }
}

void Descriptors::freed(std::span<const VkDescriptorSet> sets) {
  const std::lock_guard lock(mutex_);
  for (const VkDescriptorSet set : sets) {
    sets_.erase(set);
  }
}

void Descriptors::pool_emptied(VkDescriptorPool pool) {
  const std::lock_guard lock(mutex_);
  std::erase_if(sets_, [pool](const auto& entry) { return entry.second.pool == pool; });
}

DescriptorSlot Descriptors::place(const Layout* layout, DescriptorSlot first,
                                  std::uint32_t offset) {
  DescriptorSlot slot{first.binding, first.element + offset};
  if (layout == nullptr) {
    return slot;
  }
  for (auto at = layout->find(slot.binding); at != layout->end(); ++at) {
    slot.binding = at->first;
    if (slot.element < at->second) {
      return slot;
    }
    slot.element -= at->second;
  }
  return slot;
}

void Descriptors::write(StructureDescriptors& target, const Layout* layout,
                        const VkWriteDescriptorSet& write) {
  if (write.descriptorType != VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR) {
    return;
  }
  const auto* structures = find_in_chain<VkWriteDescriptorSetAccelerationStructureKHR>(
      write.pNext, VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR);
  if (structures == nullptr) {
    return;
  }
  for (std::uint32_t i = 0; i < structures->accelerationStructureCount; ++i) {
    target[place(layout, {write.dstBinding, write.dstArrayElement}, i)] =
        structures->pAccelerationStructures[i];
  }
}

void Descriptors::apply_template(StructureDescriptors& target, const Layout* layout,
                                 std::span<const VkDescriptorUpdateTemplateEntry> entries,
                                 const void* data) {
  for (const VkDescriptorUpdateTemplateEntry& entry : entries) {
    if (entry.descriptorType != VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR) {
      continue;
    }
    const auto* bytes = static_cast<const std::byte*>(data) + entry.offset;
    for (std::uint32_t i = 0; i < entry.descriptorCount; ++i) {
      VkAccelerationStructureKHR structure;
      std::memcpy(&structure, bytes + i * entry.stride, sizeof(structure));
      target[place(layout, {entry.dstBinding, entry.dstArrayElement}, i)] = structure;
    }
  }
}

void Descriptors::update(std::span<const VkWriteDescriptorSet> writes,
                         std::span<const VkCopyDescriptorSet> copies) {
  const std::lock_guard lock(mutex_);
  for (const VkWriteDescriptorSet& one : writes) {
    Set& set = sets_[one.dstSet];
    write(set.structures, set.layout.get(), one);
  }
  for (const VkCopyDescriptorSet& copy : copies) {
    const Set source = sets_[copy.srcSet];
    Set& target = sets_[copy.dstSet];
    for (std::uint32_t i = 0; i < copy.descriptorCount; ++i) {
      const auto from = source.structures.find(
          place(source.layout.get(), {copy.srcBinding, copy.srcArrayElement}, i));
      if (from != source.structures.end()) {
        target.structures[place(target.layout.get(), {copy.dstBinding, copy.dstArrayElement}, i)] =
            from->second;
      }
    }
  }
}

void Descriptors::update(VkDescriptorSet set, VkDescriptorUpdateTemplate handle, const void* data) {
  const std::lock_guard lock(mutex_);
  const auto kept = templates_.find(handle);
  if (kept != templates_.end()) {
    Set& target = sets_[set];
    apply_template(target.structures, target.layout.get(), kept->second.entries, data);
  }
}

void Descriptors::push(StructureDescriptors& target, std::span<const VkWriteDescriptorSet> writes) {
  for (const VkWriteDescriptorSet& one : writes) {
    write(target, nullptr, one);
  }
}

void Descriptors::push(StructureDescriptors& target, VkDescriptorUpdateTemplate handle,
                       const void* data) const {
  const std::lock_guard lock(mutex_);
  const auto kept = templates_.find(handle);
  if (kept != templates_.end()) {
    apply_template(target, nullptr, kept->second.entries, data);
  }
}

std::optional<VkAccelerationStructureKHR> Descriptors::find(VkDescriptorSet set,
                                                            DescriptorSlot slot) const {
  const std::lock_guard lock(mutex_);
  const auto found = sets_.find(set);
  if (found == sets_.end()) {
    return std::nullopt;
  }
  const auto structure = found->second.structures.find(slot);
  if (structure == found->second.structures.end()) {
    return std::nullopt;
  }
  return structure->second;
}

}  // namespace a2rt::layer
