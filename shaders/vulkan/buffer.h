// Host-mapped buffers.
#pragma once

#include <span>

#include "vulkan/context.h"

namespace a2rt::vulkan {

// Device memory that the host sees. Move-only; freed with the object.
class Buffer {
 public:
  Buffer() = default;
  // At least one byte is allocated, so that an empty table still has an address to bind.
  Buffer(const Context& context, VkDeviceSize bytes, VkBufferUsageFlags usage);
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Buffer();

  template <class T>
  static Buffer of(const Context& context, std::span<const T> data, VkBufferUsageFlags usage) {
    Buffer buffer(context, data.size_bytes(), usage);
    buffer.write(data.data(), data.size_bytes());
    return buffer;
  }
  void write(const void* data, std::size_t bytes);
  const void* mapped() const { return mapped_; }
  void* mapped() { return mapped_; }
  VkBuffer handle() const { return buffer_; }
  VkDeviceSize bytes() const { return bytes_; }
  VkDeviceAddress address() const;

 private:
  void swap(Buffer& other) noexcept;

  const Context* context_ = nullptr;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  void* mapped_ = nullptr;
  VkDeviceSize bytes_ = 0;
};

}  // namespace a2rt::vulkan
