#include "vulkan/buffer.h"

#include <cstring>
#include <utility>

#include "a2rt/base/error.h"

namespace a2rt::vulkan {

Buffer::Buffer(const Context& context, VkDeviceSize bytes, VkBufferUsageFlags usage)
    : context_(&context), bytes_(std::max<VkDeviceSize>(bytes, 64)) {
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = bytes_;
  info.usage = usage | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
  check(vkCreateBuffer(context.device(), &info, nullptr, &buffer_), "vkCreateBuffer");
  VkMemoryRequirements needs{};
  vkGetBufferMemoryRequirements(context.device(), buffer_, &needs);
  VkMemoryAllocateFlagsInfo flags{};
  flags.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO;
  flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  VkMemoryAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  allocate.pNext = &flags;
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex =
      context.memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                                    VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  check(vkAllocateMemory(context.device(), &allocate, nullptr, &memory_), "vkAllocateMemory");
  check(vkBindBufferMemory(context.device(), buffer_, memory_, 0), "vkBindBufferMemory");
  check(vkMapMemory(context.device(), memory_, 0, VK_WHOLE_SIZE, 0, &mapped_), "vkMapMemory");
}

Buffer::~Buffer() {
  if (context_ != nullptr) {
    vkDestroyBuffer(context_->device(), buffer_, nullptr);
    vkFreeMemory(context_->device(), memory_, nullptr);
  }
}

void Buffer::write(const void* data, std::size_t bytes) {
  A2RT_CHECK(bytes <= bytes_, "write past the end of a buffer");
  if (bytes > 0) {
    std::memcpy(mapped_, data, bytes);
  }
}

VkDeviceAddress Buffer::address() const {
  VkBufferDeviceAddressInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO;
  info.buffer = buffer_;
  return vkGetBufferDeviceAddress(context_->device(), &info);
}

void Buffer::swap(Buffer& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(buffer_, other.buffer_);
  std::swap(memory_, other.memory_);
  std::swap(mapped_, other.mapped_);
  std::swap(bytes_, other.bytes_);
}

}  // namespace a2rt::vulkan
