// A layout whose one set is pushed into command buffers: binding 0 a structure, 1 a buffer.
#pragma once

#include <array>

#include "harness/app.h"

namespace foreign {

class PushLayout {
 public:
  explicit PushLayout(App& app);
  ~PushLayout();
  PushLayout(const PushLayout&) = delete;
  PushLayout& operator=(const PushLayout&) = delete;

  VkPipelineLayout layout() const { return layout_; }
  VkDescriptorSetLayout set_layout() const { return set_layout_; }

 private:
  App& app_;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
};

// The writes of both bindings; they point into this object.
struct PushWrites {
  PushWrites(App& app, const Structure& tlas);
  PushWrites(const PushWrites&) = delete;
  PushWrites& operator=(const PushWrites&) = delete;

  VkAccelerationStructureKHR handle;
  VkWriteDescriptorSetAccelerationStructureKHR structure{};
  VkDescriptorBufferInfo picture{};
  std::array<VkWriteDescriptorSet, 2> list{};
};

// What an update template of both bindings reads.
struct TemplateData {
  VkAccelerationStructureKHR structure;
  VkDescriptorBufferInfo picture;
};
// Of a set of `set_layout`, or for pushing into `layout` if `set_layout` is null.
VkDescriptorUpdateTemplate make_template(App& app, VkDescriptorSetLayout set_layout,
                                         VkPipelineLayout layout);

}  // namespace foreign
