// Storage images that shaders draw into, and textures with their samplers.
#pragma once

#include <vector>

#include "vulkan/buffer.h"

namespace a2rt::vulkan {

// A 2D image with a view. Move-only.
class Image {
 public:
  Image() = default;
  Image(const Context& context, std::uint32_t width, std::uint32_t height, VkFormat format,
        VkImageUsageFlags usage);
  Image(Image&& other) noexcept { swap(other); }
  Image& operator=(Image&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Image();

  VkImage handle() const { return image_; }
  VkImageView view() const { return view_; }
  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }

  // Layout change with a full barrier; `from` is what the image was last left in.
  void transition(VkCommandBuffer commands, VkImageLayout from, VkImageLayout to) const;
  // Fills the image (RGBA8) and leaves it ready for sampling.
  void upload(const Context& context, const std::vector<std::uint8_t>& rgba) const;
  // Copies an image in the general layout into `target`, tightly packed.
  void read_back(VkCommandBuffer commands, const Buffer& target) const;

 private:
  void swap(Image& other) noexcept;

  const Context* context_ = nullptr;
  VkImage image_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  VkImageView view_ = VK_NULL_HANDLE;
  std::uint32_t width_ = 0, height_ = 0;
};

struct SamplerOptions {
  VkFilter filter = VK_FILTER_LINEAR;
  VkSamplerAddressMode u = VK_SAMPLER_ADDRESS_MODE_REPEAT, v = VK_SAMPLER_ADDRESS_MODE_REPEAT;
};

class Sampler {
 public:
  Sampler(const Context& context, const SamplerOptions& options);
  Sampler(Sampler&& other) noexcept : context_(other.context_), sampler_(other.sampler_) {
    other.sampler_ = VK_NULL_HANDLE;
  }
  Sampler& operator=(Sampler&&) = delete;
  ~Sampler();
  VkSampler handle() const { return sampler_; }

 private:
  const Context* context_;
  VkSampler sampler_ = VK_NULL_HANDLE;
};

}  // namespace a2rt::vulkan
