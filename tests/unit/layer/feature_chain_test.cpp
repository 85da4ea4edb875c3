#include "layer/feature_chain.h"

#include <gtest/gtest.h>

namespace a2rt::layer {
namespace {

template <class T>
const T* find(const VkDeviceCreateInfo& info, VkStructureType type) {
  for (auto* item = static_cast<const VkBaseInStructure*>(info.pNext); item != nullptr;
       item = item->pNext) {
    if (item->sType == type) {
      return reinterpret_cast<const T*>(item);
    }
  }
  return nullptr;
}

std::size_t length(const VkDeviceCreateInfo& info) {
  std::size_t count = 0;
  for (auto* item = static_cast<const VkBaseInStructure*>(info.pNext); item != nullptr;
       item = item->pNext) {
    ++count;
  }
  return count;
}

constexpr auto kQueryType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR;
constexpr auto kAddressType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES;
constexpr auto kTwelveType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;

// Writing to constant data would end the test.
const VkPhysicalDeviceFeatures2 kFeatures{
    VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, nullptr, {}};
const VkPhysicalDeviceRayQueryFeaturesKHR kQuery{
    kQueryType, const_cast<VkPhysicalDeviceFeatures2*>(&kFeatures), VK_TRUE};
const VkPhysicalDeviceBufferDeviceAddressFeatures kAddresses{
    kAddressType, const_cast<VkPhysicalDeviceRayQueryFeaturesKHR*>(&kQuery), VK_FALSE, VK_TRUE,
    VK_FALSE};

TEST(FeatureChain, constant_structures_are_copied) {
  VkDeviceCreateInfo program{};
  program.pNext = &kAddresses;
  const FeatureChain chain(program);
  const VkDeviceCreateInfo& info = *chain.info();
  EXPECT_EQ(length(info), 3u);
  const auto* addresses = find<VkPhysicalDeviceBufferDeviceAddressFeatures>(info, kAddressType);
  EXPECT_EQ(addresses->bufferDeviceAddress, VK_TRUE);
  EXPECT_EQ(addresses->bufferDeviceAddressCaptureReplay, VK_TRUE);
  EXPECT_EQ(find<VkPhysicalDeviceRayQueryFeaturesKHR>(info, kQueryType)->rayQuery, VK_TRUE);
  EXPECT_EQ(
      find<VkPhysicalDeviceFeatures2>(info, kFeatures.sType)->features.fragmentStoresAndAtomics,
      VK_TRUE);
  EXPECT_EQ(kAddresses.bufferDeviceAddress, VK_FALSE);
  EXPECT_EQ(kAddresses.pNext, &kQuery);
}

TEST(FeatureChain, what_follows_the_last_change_is_shared) {
  const VkPhysicalDeviceRayQueryFeaturesKHR last{kQueryType, nullptr, VK_TRUE};
  VkPhysicalDeviceVulkan12Features twelve{};
  twelve.sType = kTwelveType;
  twelve.pNext = const_cast<VkPhysicalDeviceRayQueryFeaturesKHR*>(&last);
  VkDeviceCreateInfo program{};
  program.pNext = &twelve;
  const FeatureChain chain(program);
  EXPECT_EQ(length(*chain.info()), 2u);
  const auto* changed = find<VkPhysicalDeviceVulkan12Features>(*chain.info(), kTwelveType);
  EXPECT_NE(changed, &twelve);
  EXPECT_EQ(changed->bufferDeviceAddress, VK_TRUE);
  EXPECT_EQ(changed->pNext, &last);
  twelve.bufferDeviceAddress = VK_TRUE;
  EXPECT_EQ(FeatureChain(program).info()->pNext, &twelve);
}

TEST(FeatureChain, a_structure_of_unknown_size_is_still_passed_on) {
  const VkPhysicalDeviceBufferDeviceAddressFeatures addresses{kAddressType, nullptr, VK_FALSE,
                                                              VK_FALSE, VK_FALSE};
  const auto* const behind = reinterpret_cast<const VkBaseInStructure*>(&addresses);
  const VkBaseInStructure unknown{static_cast<VkStructureType>(1999999999), behind};
  VkDeviceCreateInfo program{};
  program.pNext = &unknown;
  const FeatureChain chain(program);
  EXPECT_EQ(find<VkBaseInStructure>(*chain.info(), unknown.sType), &unknown);
  EXPECT_EQ(find<VkPhysicalDeviceBufferDeviceAddressFeatures>(*chain.info(), kAddressType)
                ->bufferDeviceAddress,
            VK_TRUE);
}

TEST(FeatureChain, features_that_the_program_never_named_are_added) {
  const VkPhysicalDeviceFeatures features{};
  VkDeviceCreateInfo program{};
  program.pEnabledFeatures = &features;
  const FeatureChain chain(program);
  EXPECT_EQ(chain.info()->pEnabledFeatures->fragmentStoresAndAtomics, VK_TRUE);
  EXPECT_EQ(features.fragmentStoresAndAtomics, VK_FALSE);
  ASSERT_NE(find<VkBaseInStructure>(*chain.info(), kAddressType), nullptr);
}

}  // namespace
}  // namespace a2rt::layer
