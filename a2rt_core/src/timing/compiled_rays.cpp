#include "a2rt/timing/compiled_rays.h"

#include <algorithm>
#include <array>
#include <new>
#include <tuple>

namespace a2rt::timing {
namespace {

auto what_matters(const RtConfig& c) {
  return std::tie(c.stack_entries, c.stack_entry_bytes, c.context, c.context_entries,
                  c.context_bytes);
}

}  // namespace

CompiledRays::CompiledRays(const RtConfig& config, std::size_t rays, Bytes most)
    : config_(config), rays_(rays), most_chunks_(most.value / kChunk) {}

bool CompiledRays::serve(const RtConfig& config) const {
  return what_matters(config) == what_matters(config_);
}

std::byte* CompiledRays::room(std::size_t bytes) {
  if (bytes > kChunk - used_) {
    if (bytes > kChunk || chunks_.size() >= most_chunks_) {
      return nullptr;
    }
    chunks_.push_back(std::make_unique_for_overwrite<std::byte[]>(kChunk));
    used_ = 0;
  }
  std::byte* const at = chunks_.back().get() + used_;
  used_ += bytes;
  return at;
}

void CompiledRays::keep(std::uint32_t ray, const LaneOp* ops, std::size_t size, Address spill,
                        const LaneOpCounts& before, const LaneOpCounts& after) {
  const auto from = LaneOpCounts::as_numbers(before), to = LaneOpCounts::as_numbers(after);
  std::array<LaneOpCount, LaneOpCounts::kNumbers> counts;
  std::uint8_t counted = 0;
  for (std::uint32_t i = 0; i < from.size(); ++i) {
    const std::uint64_t n = to[i] - from[i];
    if (n > LaneOpCount::kMost) {
      return;
    }
    if (n > 0) {
      counts[counted++] = {i, n};
    }
  }
  const std::size_t op_bytes = size * sizeof(LaneOp);
  const std::size_t count_bytes = counted * sizeof(LaneOpCount);
  std::byte* const at =
      room(op_bytes + (count_bytes + sizeof(LaneOp) - 1) / sizeof(LaneOp) * sizeof(LaneOp));
  if (at == nullptr) {
    return;
  }
  auto* const kept = new (at) LaneOp[size];
  std::copy_n(counts.begin(), counted, new (at + op_bytes) LaneOpCount[counted]);
  bool spills = false;
  for (std::size_t i = 0; i < size; ++i) {
    spills |= ops[i].names_spill_memory();
    kept[i] = ops[i].names_spill_memory() ? ops[i].moved(spill, Address{0}) : ops[i];
  }
  rays_[ray] = {kept, static_cast<std::uint32_t>(size), counted, spills};
  ++kept_;
}

CompiledRays* RepeatedRays::compiled(const RtConfig& config) {
  if (!compiled_ || !compiled_->serve(config)) {
    compiled_.emplace(config, count_, most_);
  }
  return &*compiled_;
}

}  // namespace a2rt::timing
