// SAH build of a wide BVH with Embree's rtcBuildBVH (the A2RT paper's 6-wide Embree tree, V.A).
//
// The result is a function of the input alone: Embree runs on one thread, and the boxes are
// recomputed bottom-up from the primitives, so they are tight and free of Embree's scaling.
#pragma once

#include <cstdint>
#include <span>

#include "a2rt/base/vec.h"
#include "a2rt/bvh/wide_bvh.h"
#include "a2rt/workload/workload.h"

namespace a2rt::bvh {

struct WideBuildConfig {
  // Children of a node, 2..8. The paper and AQB8's 6-wide branch use 6.
  unsigned branching = 6;
  // Primitives in a leaf, 1..16. AQB8 gives Embree 1..7 (its leaf word has three bits for the
  // count) and the A2RT paper compares on the same trees, so 7 is the default. The SAH, with
  // traversal and intersection cost 1 as there, still makes smaller leaves where they pay.
  unsigned max_leaf = 7;
};

class WideBuilder {
 public:
  // Throws UserError if a value is out of range or Embree cannot start.
  explicit WideBuilder(const WideBuildConfig& config);
  ~WideBuilder();
  WideBuilder(const WideBuilder&) = delete;
  WideBuilder& operator=(const WideBuilder&) = delete;

  // Primitives with a NaN or infinite coordinate are inactive (Vulkan specification, "inactive
  // primitives") and left out; degenerate ones stay. Throws UserError if Embree fails.
  [[nodiscard]] WideBvh build(std::span<const Triangle> triangles) const;
  // Likewise; an inverted box is inactive as well.
  [[nodiscard]] WideBvh build(std::span<const Box> boxes) const;

 private:
  WideBuildConfig config_;
  void* device_;  // RTCDevice, kept opaque so that Embree's headers stay in one .cpp
};

// Box of a primitive; an inactive one yields an empty (invalid) box.
Box active_box(const Triangle& triangle);
Box active_box(const Box& box);

}  // namespace a2rt::bvh
