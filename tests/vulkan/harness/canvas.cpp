#include "harness/canvas.h"

namespace foreign {
namespace {

constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_UNORM;
constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;
constexpr VkRect2D kArea{{0, 0}, {kWidth, kHeight}};

}  // namespace

Canvas::Canvas(App& app, Way way, const std::vector<Stage>& stages, Hidden hidden)
    : app_(app), way_(way), hidden_(hidden) {
  color_ =
      make_image(kFormat, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                 VK_IMAGE_ASPECT_COLOR_BIT);
  if (hidden_ != Hidden::kNothing) {
    depth_ = make_image(kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                        VK_IMAGE_ASPECT_DEPTH_BIT);
  }
  if (way_ == Way::kRenderPass) {
    make_pass();
  }
  make_pipeline(stages);
}

Canvas::~Canvas() {
  vkDestroyPipeline(app_.device(), pipeline_, nullptr);
  vkDestroyFramebuffer(app_.device(), framebuffer_, nullptr);
  vkDestroyRenderPass(app_.device(), pass_, nullptr);
  destroy(color_);
  destroy(depth_);
}

void Canvas::destroy(const Image& image) const {
  vkDestroyImageView(app_.device(), image.view, nullptr);
  vkDestroyImage(app_.device(), image.handle, nullptr);
  vkFreeMemory(app_.device(), image.memory, nullptr);
}

Canvas::Image Canvas::make_image(VkFormat format, VkImageUsageFlags usage,
                                 VkImageAspectFlags aspect) const {
  Image made;
  VkImageCreateInfo image{};
  image.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  image.imageType = VK_IMAGE_TYPE_2D;
  image.format = format;
  image.extent = {kWidth, kHeight, 1};
  image.mipLevels = 1;
  image.arrayLayers = 1;
  image.samples = VK_SAMPLE_COUNT_1_BIT;
  image.usage = usage;
  check(vkCreateImage(app_.device(), &image, nullptr, &made.handle), "vkCreateImage");
  VkMemoryRequirements needs{};
  vkGetImageMemoryRequirements(app_.device(), made.handle, &needs);
  VkMemoryAllocateInfo allocation{};
  allocation.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  allocation.allocationSize = needs.size;
  check(vkAllocateMemory(app_.device(), &allocation, nullptr, &made.memory), "memory");
  check(vkBindImageMemory(app_.device(), made.handle, made.memory, 0), "vkBindImageMemory");
  VkImageViewCreateInfo view{};
  view.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  view.image = made.handle;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = image.format;
  view.subresourceRange = {aspect, 0, 1, 0, 1};
  check(vkCreateImageView(app_.device(), &view, nullptr, &made.view), "vkCreateImageView");
  return made;
}

void Canvas::make_pass() {
  VkAttachmentDescription attachment{};
  attachment.format = kFormat;
  attachment.samples = VK_SAMPLE_COUNT_1_BIT;
  attachment.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  attachment.initialLayout = attachment.finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  const VkAttachmentReference color{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &color;
  VkRenderPassCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO;
  info.attachmentCount = 1;
  info.pAttachments = &attachment;
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  check(vkCreateRenderPass(app_.device(), &info, nullptr, &pass_), "vkCreateRenderPass");
  VkFramebufferCreateInfo frame{};
  frame.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO;
  frame.renderPass = pass_;
  frame.attachmentCount = 1;
  frame.pAttachments = &color_.view;
  frame.width = kWidth;
  frame.height = kHeight;
  frame.layers = 1;
  check(vkCreateFramebuffer(app_.device(), &frame, nullptr, &framebuffer_), "vkCreateFramebuffer");
}

void Canvas::make_pipeline(const std::vector<Stage>& list) {
  std::vector<VkPipelineShaderStageCreateInfo> stages;
  for (const Stage& stage : list) {
    stages.push_back(app_.stage_info(stage));
  }
  VkPipelineVertexInputStateCreateInfo input{};
  input.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
  VkPipelineInputAssemblyStateCreateInfo assembly{};
  assembly.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO;
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  const VkViewport viewport{0, 0, kWidth, kHeight, 0, 1};
  const VkRect2D scissor{{0, 0}, {kWidth, kHeight}};
  VkPipelineViewportStateCreateInfo view{};
  view.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO;
  view.viewportCount = 1;
  view.pViewports = &viewport;
  view.scissorCount = 1;
  view.pScissors = &scissor;
  VkPipelineRasterizationStateCreateInfo raster{};
  raster.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO;
  raster.lineWidth = 1;
  VkPipelineMultisampleStateCreateInfo samples{};
  samples.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO;
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  samples.alphaToCoverageEnable = hidden_ == Hidden::kByDepthAndCoverage;
  VkPipelineDepthStencilStateCreateInfo depth{};
  depth.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO;
  depth.depthTestEnable = depth.depthWriteEnable = hidden_ != Hidden::kNothing;
  depth.depthCompareOp = VK_COMPARE_OP_LESS;
  VkPipelineColorBlendAttachmentState attachment{};
  attachment.colorWriteMask = 0xf;
  VkPipelineColorBlendStateCreateInfo blend{};
  blend.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
  blend.attachmentCount = 1;
  blend.pAttachments = &attachment;
  VkPipelineRenderingCreateInfo rendering{};
  rendering.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO;
  rendering.colorAttachmentCount = 1;
  rendering.pColorAttachmentFormats = &kFormat;
  rendering.depthAttachmentFormat =
      hidden_ == Hidden::kNothing ? VK_FORMAT_UNDEFINED : kDepthFormat;
  VkGraphicsPipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO;
  info.pNext = way_ == Way::kRendering ? &rendering : nullptr;
  info.renderPass = pass_;
  info.stageCount = static_cast<std::uint32_t>(stages.size());
  info.pStages = stages.data();
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &view;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.layout = app_.layout();
  check(vkCreateGraphicsPipelines(app_.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline_),
        "vkCreateGraphicsPipelines");
}

void Canvas::to_layout(VkCommandBuffer commands, const Image& image, VkImageAspectFlags aspect,
                       VkImageLayout from, VkImageLayout to) const {
  VkImageMemoryBarrier barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
  barrier.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.image = image.handle;
  barrier.subresourceRange = {aspect, 0, 1, 0, 1};
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                       VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, nullptr, 0, nullptr, 1, &barrier);
}

void Canvas::begin(VkCommandBuffer commands, VkSubpassContents contents) {
  to_layout(commands, color_, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
            VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
  if (way_ == Way::kRenderPass) {
    const VkClearValue clear{};
    VkRenderPassBeginInfo info{};
    info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO;
    info.renderPass = pass_;
    info.framebuffer = framebuffer_;
    info.renderArea = kArea;
    info.clearValueCount = 1;
    info.pClearValues = &clear;
    vkCmdBeginRenderPass(commands, &info, contents);
    return;
  }
  VkRenderingAttachmentInfo color{};
  color.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
  color.imageView = color_.view;
  color.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  color.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  color.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  VkRenderingAttachmentInfo depth{};
  depth.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
  depth.imageView = depth_.view;
  depth.imageLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  depth.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  depth.clearValue.depthStencil.depth = 1;
  if (hidden_ != Hidden::kNothing) {
    to_layout(commands, depth_, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
              depth.imageLayout);
  }
  VkRenderingInfo rendering{};
  rendering.sType = VK_STRUCTURE_TYPE_RENDERING_INFO;
  rendering.renderArea = kArea;
  rendering.layerCount = 1;
  rendering.colorAttachmentCount = 1;
  rendering.pColorAttachments = &color;
  rendering.pDepthAttachment = hidden_ == Hidden::kNothing ? nullptr : &depth;
  vkCmdBeginRendering(commands, &rendering);
}

void Canvas::bind(VkCommandBuffer commands, VkDescriptorSet set) {
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, app_.layout(), 0, 1, &set, 0,
                          nullptr);
}

void Canvas::end(VkCommandBuffer commands) {
  if (way_ == Way::kRenderPass) {
    vkCmdEndRenderPass(commands);
  } else {
    vkCmdEndRendering(commands);
  }
  to_layout(commands, color_, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
            VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  VkBufferImageCopy copy{};
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  copy.imageExtent = {kWidth, kHeight, 1};
  vkCmdCopyImageToBuffer(commands, color_.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                         app_.picture().handle, 1, &copy);
  App::barrier(commands);
}

}  // namespace foreign
