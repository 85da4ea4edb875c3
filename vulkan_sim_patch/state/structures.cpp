#include "state/structures.h"

namespace a2rt::layer {

void Structures::created(VkAccelerationStructureKHR structure, VkDeviceAddress address) {
  const std::lock_guard lock(mutex_);
  addresses_[structure] = address;
  contents_.erase(address);
}

void Structures::destroyed(VkAccelerationStructureKHR structure) {
  const std::lock_guard lock(mutex_);
  addresses_.erase(structure);
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
