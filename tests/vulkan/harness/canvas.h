// An image to draw into, in a render pass or by dynamic rendering, with a pipeline that fills it.
#pragma once

#include "harness/app.h"

namespace foreign {

class Canvas {
 public:
  enum class Way { kRendering, kRenderPass };
  // What hides fragments; other than kNothing only by dynamic rendering.
  enum class Hidden { kNothing, kByDepth, kByDepthAndCoverage };
  // `stages` are those of the pipeline.
  Canvas(App& app, Way way, const std::vector<Stage>& stages, Hidden hidden = Hidden::kNothing);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  VkRenderPass pass() const { return pass_; }
  VkFramebuffer framebuffer() const { return framebuffer_; }

  void begin(VkCommandBuffer commands, VkSubpassContents contents = VK_SUBPASS_CONTENTS_INLINE);
  // Binds the pipeline and its set.
  void bind(VkCommandBuffer commands, VkDescriptorSet set);
  // Ends the pass and copies the image into the program's picture.
  void end(VkCommandBuffer commands);

 private:
  struct Image {
    VkImage handle = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
  };
  Image make_image(VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect) const;
  void destroy(const Image& image) const;
  void make_pass();
  void make_pipeline(const std::vector<Stage>& stages);
  void to_layout(VkCommandBuffer commands, const Image& image, VkImageAspectFlags aspect,
                 VkImageLayout from, VkImageLayout to) const;

  App& app_;
  Way way_;
  Hidden hidden_;
  Image color_, depth_;
  VkRenderPass pass_ = VK_NULL_HANDLE;
  VkFramebuffer framebuffer_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

}  // namespace foreign
