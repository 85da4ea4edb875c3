#include "state/structures.h"

#include <algorithm>

namespace a2rt::layer {

void Structures::created(VkAccelerationStructureKHR structure, VkDeviceAddress address) {
  const std::lock_guard lock(mutex_);
  addresses_[structure] = address;
  contents_.erase(address);
}

std::optional<VkDeviceAddress> Structures::destroyed(VkAccelerationStructureKHR structure) {
  const std::lock_guard lock(mutex_);
  const auto found = addresses_.find(structure);
  if (found == addresses_.end()) {
    return std::nullopt;
  }
  const VkDeviceAddress address = found->second;
  addresses_.erase(found);
  // Another structure may have been created in the same place meanwhile.
  const bool is_reused = std::any_of(addresses_.begin(), addresses_.end(),
                                     [=](const auto& other) { return other.second == address; });
  return !is_reused && contents_.erase(address) != 0 ? std::optional(address) : std::nullopt;
}

VkDeviceAddress Structures::address(VkAccelerationStructureKHR structure) const {
  const std::lock_guard lock(mutex_);
  const auto found = addresses_.find(structure);
  return found == addresses_.end() ? 0 : found->second;
}

std::uint64_t Structures::new_id() {
  const std::lock_guard lock(mutex_);
  return ++last_id_;
}

void Structures::built(VkDeviceAddress address, const BuiltStructure& what) {
  const std::lock_guard lock(mutex_);
  contents_[address] = what;
  any_non_opaque_ = any_non_opaque_ || what.has_non_opaque;
}

std::optional<BuiltStructure> Structures::at(VkDeviceAddress address) const {
  const std::lock_guard lock(mutex_);
  const auto found = contents_.find(address);
  if (found == contents_.end()) {
    return std::nullopt;
  }
  return found->second;
}

bool Structures::any_non_opaque() const {
  const std::lock_guard lock(mutex_);
  return any_non_opaque_;
}

}  // namespace a2rt::layer
