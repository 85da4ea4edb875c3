#include "state/command_buffers.h"

#include <algorithm>
#include <utility>

namespace a2rt::layer {
namespace {

void append(std::vector<std::uint64_t>& target, const std::vector<std::uint64_t>& more) {
  target.insert(target.end(), more.begin(), more.end());
}

std::vector<std::uint64_t> renew(std::shared_ptr<CommandBufferState>& state) {
  auto callbacks = std::move(state->callbacks);
  const VkCommandPool pool = state->pool;
  state = std::make_shared<CommandBufferState>();
  state->pool = pool;
  return callbacks;
}

}  // namespace

std::uint64_t CommandBufferState::traced_work() const {
  const auto tracing = std::count_if(passes.begin(), passes.end(),
                                     [](const auto& pass) { return !pass->draws.empty(); });
  return dispatch_count + static_cast<std::uint64_t>(tracing);
}

void CommandBuffers::allocated(VkCommandPool pool, const VkCommandBuffer* buffers,
                               std::uint32_t count) {
  const std::lock_guard lock(mutex_);
  for (std::uint32_t i = 0; i < count; ++i) {
    auto state = std::make_shared<CommandBufferState>();
    state->pool = pool;
    states_[buffers[i]] = std::move(state);
  }
}

std::vector<std::uint64_t> CommandBuffers::reset(VkCommandBuffer buffer) {
  const std::lock_guard lock(mutex_);
  auto& state = states_[buffer];
  if (state == nullptr) {
    state = std::make_shared<CommandBufferState>();
  }
  return renew(state);
}

std::vector<std::uint64_t> CommandBuffers::freed(const VkCommandBuffer* buffers,
                                                 std::uint32_t count) {
  const std::lock_guard lock(mutex_);
  std::vector<std::uint64_t> callbacks;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto found = states_.find(buffers[i]);
    if (found != states_.end()) {
      append(callbacks, found->second->callbacks);
      states_.erase(found);
    }
  }
  return callbacks;
}

std::vector<std::uint64_t> CommandBuffers::pool_reset(VkCommandPool pool) {
  const std::lock_guard lock(mutex_);
  std::vector<std::uint64_t> callbacks;
  for (auto& [buffer, state] : states_) {
    if (state->pool == pool) {
      append(callbacks, renew(state));
    }
  }
  return callbacks;
}

std::vector<std::uint64_t> CommandBuffers::pool_destroyed(VkCommandPool pool) {
  const std::lock_guard lock(mutex_);
  std::vector<std::uint64_t> callbacks;
  std::erase_if(states_, [&](const auto& entry) {
    if (entry.second->pool != pool) {
      return false;
    }
    append(callbacks, entry.second->callbacks);
    return true;
  });
  return callbacks;
}

std::shared_ptr<CommandBufferState> CommandBuffers::find(VkCommandBuffer buffer) {
  const std::lock_guard lock(mutex_);
  auto& state = states_[buffer];
  if (state == nullptr) {
    state = std::make_shared<CommandBufferState>();
  }
  return state;
}

}  // namespace a2rt::layer
