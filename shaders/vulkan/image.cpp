#include "vulkan/image.h"

#include <utility>

namespace a2rt::vulkan {

Image::Image(const Context& context, std::uint32_t width, std::uint32_t height, VkFormat format,
             VkImageUsageFlags usage)
    : context_(&context), width_(width), height_(height) {
  VkImageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent = {width, height, 1};
  info.mipLevels = 1;
  info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = usage;
  check(vkCreateImage(context.device(), &info, nullptr, &image_), "vkCreateImage");
  VkMemoryRequirements needs{};
  vkGetImageMemoryRequirements(context.device(), image_, &needs);
  VkMemoryAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex =
      context.memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  check(vkAllocateMemory(context.device(), &allocate, nullptr, &memory_), "vkAllocateMemory");
  check(vkBindImageMemory(context.device(), image_, memory_, 0), "vkBindImageMemory");
  VkImageViewCreateInfo view{};
  view.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  view.image = image_;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = format;
  view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  check(vkCreateImageView(context.device(), &view, nullptr, &view_), "vkCreateImageView");
}

Image::~Image() {
  if (context_ != nullptr) {
    vkDestroyImageView(context_->device(), view_, nullptr);
    vkDestroyImage(context_->device(), image_, nullptr);
    vkFreeMemory(context_->device(), memory_, nullptr);
  }
}

void Image::swap(Image& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(image_, other.image_);
  std::swap(memory_, other.memory_);
  std::swap(view_, other.view_);
  std::swap(width_, other.width_);
  std::swap(height_, other.height_);
}

void Image::transition(VkCommandBuffer commands, VkImageLayout from, VkImageLayout to) const {
  VkImageMemoryBarrier barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
  barrier.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image_;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                       VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, nullptr, 0, nullptr, 1, &barrier);
}

void Image::upload(const Context& context, const std::vector<std::uint8_t>& rgba) const {
  const Buffer staging = Buffer::of<std::uint8_t>(context, rgba, VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
  context.run([&](VkCommandBuffer commands) {
    transition(commands, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageExtent = {width_, height_, 1};
    vkCmdCopyBufferToImage(commands, staging.handle(), image_, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                           1, &region);
    transition(commands, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
               VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  });
}

void Image::read_back(VkCommandBuffer commands, const Buffer& target) const {
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {width_, height_, 1};
  vkCmdCopyImageToBuffer(commands, image_, VK_IMAGE_LAYOUT_GENERAL, target.handle(), 1, &region);
}

Sampler::Sampler(const Context& context, const SamplerOptions& options) : context_(&context) {
  VkSamplerCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
  info.magFilter = options.filter;
  info.minFilter = options.filter;
  info.addressModeU = options.u;
  info.addressModeV = options.v;
  info.addressModeW = VK_SAMPLER_ADDRESS_MODE_REPEAT;
  check(vkCreateSampler(context.device(), &info, nullptr, &sampler_), "vkCreateSampler");
}

Sampler::~Sampler() {
  if (sampler_ != VK_NULL_HANDLE) {
    vkDestroySampler(context_->device(), sampler_, nullptr);
  }
}

}  // namespace a2rt::vulkan
