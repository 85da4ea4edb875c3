// Ray queries in a compute shader whose group size is a specialization constant.
#pragma once

#include "harness/app.h"

namespace foreign {

inline constexpr std::uint32_t kGroupWidth = 8, kGroupHeight = 4;

// Makes a pipeline of `stage` (query.comp or a copy of it) with groups of kGroupWidth times
// kGroupHeight, binds it and `set`, records what `dispatch` does, and waits for its end.
void run_query(App& app, VkPipelineShaderStageCreateInfo stage, VkPipelineCreateFlags flags,
               VkDescriptorSet set, const std::function<void(VkCommandBuffer)>& dispatch);

}  // namespace foreign
