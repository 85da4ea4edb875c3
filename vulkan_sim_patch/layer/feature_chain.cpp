#include "layer/feature_chain.h"

#include <vulkan/vk_layer.h>

#include <algorithm>
#include <cstring>

namespace a2rt::layer {
namespace {

struct StructureSize {
  VkStructureType type;
  std::size_t bytes;
};
constexpr StructureSize kSizes[] = {
    {VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO, sizeof(VkLayerDeviceCreateInfo)},
#include "structure_sizes.inc"
};

// 0 for a structure that is newer than the headers of this build.
std::size_t size_of(VkStructureType type) {
  const auto* const found =
      std::ranges::find_if(kSizes, [type](const StructureSize& one) { return one.type == type; });
  return found == std::end(kSizes) ? 0 : found->bytes;
}

const VkBaseInStructure* next_of(const void* item) {
  return static_cast<const VkBaseInStructure*>(item)->pNext;
}

bool has_addresses(VkStructureType type) {
  return type == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES ||
         type == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES;
}

// The one feature of a structure that the shaders need; null if it has none.
VkBool32* needed_feature(VkBaseOutStructure& item) {
  switch (item.sType) {
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES:
      return &reinterpret_cast<VkPhysicalDeviceVulkan12Features&>(item).bufferDeviceAddress;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES:
      return &reinterpret_cast<VkPhysicalDeviceBufferDeviceAddressFeatures&>(item)
                  .bufferDeviceAddress;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2:
      return &reinterpret_cast<VkPhysicalDeviceFeatures2&>(item).features.fragmentStoresAndAtomics;
    default:
      return nullptr;
  }
}

bool must_change(const VkBaseInStructure& item) {
  const VkBool32* const feature = needed_feature(
      const_cast<VkBaseOutStructure&>(reinterpret_cast<const VkBaseOutStructure&>(item)));
  return feature != nullptr && *feature == VK_FALSE;
}

}  // namespace

FeatureChain::FeatureChain(const VkDeviceCreateInfo& program) : info_(program) {
  bool addresses = false;
  const void* end = program.pNext;  // behind the last structure that must change
  for (const auto* item = static_cast<const VkBaseInStructure*>(program.pNext); item != nullptr;
       item = item->pNext) {
    addresses = addresses || has_addresses(item->sType);
    end = must_change(*item) ? item->pNext : end;
  }
  copy_until(end);
  if (program.pEnabledFeatures != nullptr) {
    features_ = *program.pEnabledFeatures;
    features_.fragmentStoresAndAtomics = VK_TRUE;
    info_.pEnabledFeatures = &features_;
  }
  if (!addresses) {
    addresses_.pNext = const_cast<void*>(info_.pNext);
    info_.pNext = &addresses_;
  }
}

void FeatureChain::copy_until(const void* end) {
  VkBaseOutStructure* last = nullptr;
  bool whole = true;
  for (const auto* item = static_cast<const VkBaseInStructure*>(info_.pNext); item != end;
       item = next_of(item)) {
    const std::size_t bytes = size_of(item->sType);
    whole = whole && bytes != 0;
    if (!whole) {
      // What cannot be copied keeps its pointer to the program's structure, which then stands in
      // the chain twice. lavapipe enables a feature that either of the two asks for.
      if (must_change(*item)) {
        put_in_front(*item, bytes);
      }
      continue;
    }
    VkBaseOutStructure* const copy = copy_of(*item, bytes);
    if (last == nullptr) {
      info_.pNext = copy;
    } else {
      last->pNext = copy;
    }
    last = copy;
  }
}

void FeatureChain::put_in_front(const VkBaseInStructure& original, std::size_t bytes) {
  VkBaseOutStructure* const copy = copy_of(original, bytes);
  copy->pNext = static_cast<VkBaseOutStructure*>(const_cast<void*>(info_.pNext));
  info_.pNext = copy;
}

VkBaseOutStructure* FeatureChain::copy_of(const VkBaseInStructure& original, std::size_t bytes) {
  copies_.push_back(std::make_unique<std::byte[]>(bytes));
  std::memcpy(copies_.back().get(), &original, bytes);
  auto* const copy = reinterpret_cast<VkBaseOutStructure*>(copies_.back().get());
  if (VkBool32* const feature = needed_feature(*copy)) {
    *feature = VK_TRUE;
  }
  return copy;
}

}  // namespace a2rt::layer
