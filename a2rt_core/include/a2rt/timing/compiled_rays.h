// What a ray's events come to in an RT unit, kept for those who time the same rays again: on
// another machine, or all of them after a sample. "Emit, then time": the emitting is done once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "a2rt/timing/lane_ops.h"
#include "a2rt/timing/ray_source.h"

namespace a2rt::timing {

// Operations of rays for RT units of one short stack and one way with contexts.
class CompiledRays {
 public:
  // Of `rays` rays; their operations and counts take no more memory than that.
  CompiledRays(const RtConfig& config, std::size_t rays, Bytes most);

  // Whether rays compiled for that RT unit are these.
  bool serve(const RtConfig& config) const;

  // A ray that is kept. Spilled entries lie in spill memory that begins at address 0.
  struct Ray {
    const LaneOp* ops = nullptr;  // nullptr: not kept
    std::uint32_t size = 0;
    std::uint8_t counted = 0;
    bool spills = false;  // some operations name spill memory
    // What compiling it counted.
    std::span<const LaneOpCount> counts() const {
      return {reinterpret_cast<const LaneOpCount*>(ops + size), counted};
    }
  };
  const Ray& find(std::uint32_t ray) const { return rays_[ray]; }
  void prefetch(const Ray& ray) const {
    __builtin_prefetch(ray.ops);
    __builtin_prefetch(ray.ops + ray.size);
    __builtin_prefetch(ray.ops + ray.size + 64 / sizeof(LaneOp));
  }
  // Keeps the operations, if there is room: `spill` is where their spill memory begins, `before`
  // and `after` what the compiler had counted before it made them and after.
  void keep(std::uint32_t ray, const LaneOp* ops, std::size_t size, Address spill,
            const LaneOpCounts& before, const LaneOpCounts& after);

  std::size_t kept() const { return kept_; }

 private:
  static constexpr std::size_t kChunk = std::size_t{1} << 23;  // bytes
  // Room for so many bytes, aligned for an operation; nullptr if there is none left.
  std::byte* room(std::size_t bytes);

  RtConfig config_;
  std::vector<Ray> rays_;
  std::vector<std::unique_ptr<std::byte[]>> chunks_;
  std::size_t most_chunks_, used_ = kChunk;  // of the last chunk
  std::size_t kept_ = 0;
};

// A source whose rays are compiled once, for the RT unit that last asked; for one thread.
class RepeatedRays final : public RaySource {
 public:
  static constexpr Bytes kMost{std::uint64_t{1} << 30};

  // `source` must outlive this. It has `rays` rays.
  RepeatedRays(RaySource& source, std::size_t rays, Bytes most = kMost)
      : source_(source), count_(rays), most_(most) {}

  void prefetch(std::uint32_t ray) const override { source_.prefetch(ray); }
  void events(std::uint32_t ray, EventReceiver& out) override { source_.events(ray, out); }
  CompiledRays* compiled(const RtConfig& config) override;

 private:
  RaySource& source_;
  std::size_t count_;
  Bytes most_;
  std::optional<CompiledRays> compiled_;
};

}  // namespace a2rt::timing
