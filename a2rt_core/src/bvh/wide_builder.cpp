#include "a2rt/bvh/wide_builder.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#include <embree4/rtcore_builder.h>
#else
#include <embree3/rtcore.h>
#include <embree3/rtcore_builder.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/base/thread_clock.h"
#include "a2rt/bvh/instance_boxes.h"

namespace a2rt::bvh {
namespace {

// What the callbacks allocate; `count` children or primitives follow in memory.
struct RawNode {
  std::uint32_t count;
  std::uint32_t leaf;
};

RawNode** children_of(RawNode* node) { return reinterpret_cast<RawNode**>(node + 1); }
std::uint32_t* primitives_of(RawNode* node) { return reinterpret_cast<std::uint32_t*>(node + 1); }

void* create_node(RTCThreadLocalAllocator allocator, unsigned count, void*) {
  void* memory =
      rtcThreadLocalAlloc(allocator, sizeof(RawNode) + count * sizeof(RawNode*), alignof(RawNode*));
  auto* node = new (memory) RawNode{count, 0};
  return node;
}

void set_children(void* node, void** children, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i) {
    children_of(static_cast<RawNode*>(node))[i] = static_cast<RawNode*>(children[i]);
  }
}

void ignore_bounds(void*, const RTCBounds**, unsigned, void*) {}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives,
                  std::size_t count, void*) {
  void* memory = rtcThreadLocalAlloc(allocator, sizeof(RawNode) + count * sizeof(std::uint32_t),
                                     alignof(RawNode*));
  auto* leaf = new (memory) RawNode{static_cast<std::uint32_t>(count), 1};
  std::uint32_t* ids = primitives_of(leaf);
  for (std::size_t i = 0; i < count; ++i) {
    ids[i] = primitives[i].primID;
  }
  // Embree's partition leaves no useful order inside a leaf; ids ascending is the one that a reader
  // of a dump expects.
  std::sort(ids, ids + count);
  return leaf;
}

// Embree's costs are areas in FP32 times counts. Coordinates beyond these bounds would overflow or
// vanish there, so the build sees them scaled by a power of two, which changes no comparison.
float build_scale(float largest) {
  constexpr float kLargest = 0x1p50F, kSmallest = 0x1p-30F;
  if (largest <= 0 || (largest <= kLargest && largest >= kSmallest)) {
    return 1;
  }
  const int exponent = std::ilogb(largest);
  return std::ldexp(1.0F, largest > kLargest ? 49 - exponent : std::min(-exponent, 126));
}

// Instances without a bound must not set the scale, or nothing would be left of the others' areas.
bool is_unbounded(const Box& b) {
  return b.hi.x >= kUnboundedReach && b.hi.y == b.hi.x && b.hi.z == b.hi.x && b.lo.x == -b.hi.x &&
         b.lo.y == -b.hi.x && b.lo.z == -b.hi.x;
}

template <class Primitive>
std::vector<RTCBuildPrimitive> build_primitives(std::span<const Primitive> all) {
  std::vector<RTCBuildPrimitive> result;
  result.reserve(all.size());
  float largest = 0;
  bool unbounded = false;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Box b = active_box(all[i]);
    if (!b.valid()) {
      continue;
    }
    const bool far = is_unbounded(b);
    unbounded = unbounded || far;
    for (std::size_t a = 0; a < 3 && !far; ++a) {
      largest = std::max({largest, std::fabs(b.lo[a]), std::fabs(b.hi[a])});
    }
    result.push_back(
        {b.lo.x, b.lo.y, b.lo.z, 0, b.hi.x, b.hi.y, b.hi.z, static_cast<std::uint32_t>(i)});
  }
  const float s = build_scale(largest), limit = largest > 0 ? largest : 1;
  if (s != 1 || unbounded) {
    for (RTCBuildPrimitive& p : result) {
      for (float* v : {&p.lower_x, &p.lower_y, &p.lower_z, &p.upper_x, &p.upper_y, &p.upper_z}) {
        *v = std::clamp(*v, -limit, limit) * s;
      }
    }
  }
  return result;
}

// Breadth-first copy; children directly after one another.
void flatten(RawNode* root, WideBvh& bvh) {
  std::vector<RawNode*> queue{root};
  std::vector<RawNode*> next;
  bvh.records.emplace_back();
  std::size_t at = 0;
  for (bvh.depth = 0; !queue.empty(); queue.swap(next)) {
    next.clear();
    for (RawNode* node : queue) {
      BvhRecord& r = bvh.records[at++];
      r.count = static_cast<std::uint16_t>(node->count);
      r.is_leaf = static_cast<std::uint16_t>(node->leaf);
      if (r.leaf()) {
        r.first = static_cast<std::uint32_t>(bvh.order.size());
        bvh.order.insert(bvh.order.end(), primitives_of(node), primitives_of(node) + node->count);
      } else {
        r.first = static_cast<std::uint32_t>(bvh.records.size());
        next.insert(next.end(), children_of(node), children_of(node) + node->count);
        bvh.records.resize(bvh.records.size() + node->count);
      }
    }
    bvh.depth += next.empty() ? 0U : 1U;
  }
}

template <class Primitive>
void fit_boxes(std::span<const Primitive> all, WideBvh& bvh) {
  // Children come after their parent, so one backward pass sees them first.
  for (std::size_t i = bvh.records.size(); i-- > 0;) {
    BvhRecord& r = bvh.records[i];
    for (std::size_t c = 0; c < r.count; ++c) {
      r.box.include(r.leaf() ? active_box(all[bvh.order[r.first + c]])
                             : bvh.records[r.first + c].box);
    }
  }
}

RTCBuildArguments build_arguments(const WideBuildConfig& config, RTCBVH tree,
                                  std::vector<RTCBuildPrimitive>& primitives) {
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = config.branching;
  arguments.minLeafSize = 1;
  arguments.maxLeafSize = config.max_leaf;
  arguments.bvh = tree;
  arguments.primitives = primitives.data();
  arguments.primitiveCount = primitives.size();
  arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = ignore_bounds;
  arguments.createLeaf = create_leaf;
  return arguments;
}

template <class Primitive>
WideBvh build_tree(RTCDevice device, const WideBuildConfig& config,
                   std::span<const Primitive> all) {
  const double start = thread_seconds();
  WideBvh bvh;
  bvh.width = config.branching;
  std::vector<RTCBuildPrimitive> primitives = build_primitives(all);
  if (primitives.empty()) {
    return bvh;
  }
  RTCBVH tree = rtcNewBVH(device);
  RTCBuildArguments arguments = build_arguments(config, tree, primitives);
  auto* root = static_cast<RawNode*>(rtcBuildBVH(&arguments));
  const RTCError error = rtcGetDeviceError(device);
  const std::size_t count = primitives.size();
  primitives = {};
  if (root == nullptr || error != RTC_ERROR_NONE) {
    rtcReleaseBVH(tree);
    throw UserError("Embree could not build a tree over " + std::to_string(count) +
                    " primitives (error " + std::to_string(static_cast<int>(error)) +
                    "); out of memory is the usual cause");
  }
  bvh.order.reserve(count);
  flatten(root, bvh);
  rtcReleaseBVH(tree);
  fit_boxes(all, bvh);
  bvh.build_seconds = thread_seconds() - start;
  return bvh;
}

}  // namespace

Box active_box(const Triangle& triangle) {
  Box box;
  for (const Vec3& v : triangle.v) {
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) {
      return {};
    }
    box.include(v);
  }
  return box;
}

Box active_box(const Box& box) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (!std::isfinite(box.lo[a]) || !std::isfinite(box.hi[a]) || box.lo[a] > box.hi[a]) {
      return {};
    }
  }
  return box;
}

WideBuilder::WideBuilder(const WideBuildConfig& config) : config_(config), device_(nullptr) {
  if (config.branching < 2 || config.branching > kMaxWidth) {
    throw UserError("tree width " + std::to_string(config.branching) + " is not in 2..8");
  }
  if (config.max_leaf < 1 || config.max_leaf > kMaxLeaf) {
    throw UserError("leaf size " + std::to_string(config.max_leaf) + " is not in 1..16");
  }
  // One thread: with more, the order of primitives inside equal bins is a race.
  device_ = rtcNewDevice("threads=1");
  if (device_ == nullptr) {
    throw UserError("Embree could not start; is libembree installed and the CPU supported?");
  }
}

WideBuilder::~WideBuilder() { rtcReleaseDevice(static_cast<RTCDevice>(device_)); }

WideBvh WideBuilder::build(std::span<const Triangle> triangles) const {
  return build_tree(static_cast<RTCDevice>(device_), config_, triangles);
}

WideBvh WideBuilder::build(std::span<const Box> boxes) const {
  return build_tree(static_cast<RTCDevice>(device_), config_, boxes);
}

}  // namespace a2rt::bvh
