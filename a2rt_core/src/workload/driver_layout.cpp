#include "a2rt/workload/driver_layout.h"

#include <cmath>
#include <cstring>

#include "driver_tree.h"

namespace a2rt::driver {
namespace {

// Driver's flag bits in sbt_offset_and_flags.
constexpr std::uint32_t kForceOpaque = 1u << 31;
constexpr std::uint32_t kNotForceNoOpaque = 1u << 30;
constexpr std::uint32_t kCullDisable = 1u << 29;
constexpr std::uint32_t kFlipFacing = 1u << 28;

// Walks the box nodes once, checking every reference before it is followed.
class TreeCheck {
 public:
  TreeCheck(const TreeView& tree, std::uint32_t leaves, NodeType leaf_type,
            std::uint32_t leaf_bytes)
      : tree_(tree),
        leaf_type_(leaf_type),
        leaf_bytes_(leaf_bytes),
        box_seen_(box_nodes(leaves)),
        leaf_seen_(leaves) {}

  std::string run() {
    visit(kRoot, 0);
    while (problem_.empty() && !pending_.empty()) {
      const Pending next = pending_.back();
      pending_.pop_back();
      expand(next);
    }
    return problem_;
  }
  bool reached(std::uint32_t leaf) const { return leaf_seen_[leaf]; }

 private:
  struct Pending {
    std::uint32_t offset;
    std::uint32_t depth;
  };
  void expand(const Pending& from) {
    const auto node = tree_.read<BoxNode>(from.offset);
    for (int k = 0; k < 2 && problem_.empty(); ++k) {
      // The root over a single leaf has no second child; its box there is inside out.
      if (node.children[k] != kInvalidNode) {
        visit(node.children[k], from.depth + 1);
      }
    }
  }
  void visit(std::uint32_t reference, std::uint32_t depth) {
    const std::uint32_t offset = reference & ~3u;
    const auto type = static_cast<NodeType>(reference & 3u);
    if (type == NodeType::kBox) {
      if (mark(box_seen_, offset, sizeof(Header), sizeof(BoxNode))) {
        pending_.push_back({offset, depth});
      }
    } else if (type != leaf_type_) {
      fail(offset, "is a leaf of the wrong type");
    } else {
      mark(leaf_seen_, offset, tree_.leaf_offset(), leaf_bytes_);
    }
    if (depth > kStackEntries) {
      fail(offset, "lies deeper than the driver's stack");
    }
  }
  bool mark(std::vector<bool>& seen, std::uint32_t offset, std::size_t first, std::size_t bytes) {
    const std::size_t index = (offset - first) / bytes;
    if (offset < first || (offset - first) % bytes != 0 || index >= seen.size()) {
      fail(offset, "is no node");
      return false;
    }
    if (seen[index]) {
      fail(offset, "is referred to twice");
      return false;
    }
    seen[index] = true;
    return true;
  }
  void fail(std::uint32_t offset, const std::string& what) {
    if (problem_.empty()) {
      problem_ = "node at byte " + std::to_string(offset) + " " + what;
    }
  }

  const TreeView& tree_;
  NodeType leaf_type_;
  std::uint32_t leaf_bytes_;
  std::vector<bool> box_seen_, leaf_seen_;
  std::vector<Pending> pending_;
  std::string problem_;
};

std::string check_sizes(std::span<const std::byte> nodes, std::uint32_t leaves,
                        std::uint32_t leaf_bytes) {
  const std::size_t leaf_offset = sizeof(Header) + box_nodes(leaves) * sizeof(BoxNode);
  const std::size_t expected = leaf_offset + std::size_t{leaves} * leaf_bytes;
  if (nodes.size() < expected) {
    return std::to_string(nodes.size()) + " bytes, expected " + std::to_string(expected) + " for " +
           std::to_string(leaves) + " leaves";
  }
  const std::uint32_t found = TreeView(nodes).leaf_offset();
  if (found != leaf_offset) {
    return "leaves start at byte " + std::to_string(found) + ", expected " +
           std::to_string(leaf_offset);
  }
  return "";
}

std::string leaf_differs(std::uint32_t leaf, const std::string& what) {
  return "leaf " + std::to_string(leaf) + ": " + what;
}

template <class Leaf, class Primitive>
std::string check_leaf(const TreeView& tree, std::uint32_t slot, const Primitive& primitive,
                       std::uint32_t geometry, std::uint32_t id, bool opaque) {
  const auto leaf = tree.read<Leaf>(tree.leaf_offset() + slot * sizeof(Leaf));
  if (std::memcmp(&leaf, &primitive, sizeof primitive) != 0) {
    return leaf_differs(slot, "coordinates differ from the captured primitive");
  }
  if (leaf.primitive != id || (leaf.geometry_and_flags & kGeometryIndexMask) != geometry) {
    return leaf_differs(slot, "primitive or geometry index differs from the captured one");
  }
  if (((leaf.geometry_and_flags & kGeometryOpaque) != 0) != opaque) {
    return leaf_differs(slot, "opaque flag differs from the captured one");
  }
  return "";
}

bool active(const Triangle& t) { return !std::isnan(t.v[0].x); }
bool active(const Box& b) { return !std::isnan(b.lo.x); }

template <class Leaf, class Primitive>
std::string check_leaves(const TreeView& tree, const TreeCheck& check, const Blas& blas,
                         const std::vector<Primitive>& primitives) {
  for (std::uint32_t g = 0; g < blas.geometries.size(); ++g) {
    const Geometry& geometry = blas.geometries[g];
    for (std::uint32_t p = 0; p < geometry.count; ++p) {
      const std::uint32_t slot = geometry.first + p;
      std::string problem = check_leaf<Leaf>(tree, slot, primitives[slot], g, p, geometry.opaque);
      if (!problem.empty()) {
        return problem;
      }
      if (!check.reached(slot) && active(primitives[slot])) {
        return leaf_differs(slot, "no box node leads to it");
      }
    }
  }
  return "";
}

template <class Leaf, class Primitive>
std::string check_typed(std::span<const std::byte> nodes, const Blas& blas, NodeType type,
                        const std::vector<Primitive>& primitives) {
  const auto leaves = static_cast<std::uint32_t>(primitives.size());
  std::string problem = check_sizes(nodes, leaves, sizeof(Leaf));
  if (!problem.empty() || leaves == 0) {
    return problem;
  }
  const TreeView tree(nodes);
  TreeCheck check(tree, leaves, type, sizeof(Leaf));
  problem = check.run();
  return problem.empty() ? check_leaves<Leaf>(tree, check, blas, primitives) : problem;
}

std::string check_instance(const InstanceLeaf& leaf, std::uint32_t place, std::uint32_t index,
                           const Instance& instance) {
  if (leaf.instance != index) {
    return leaf_differs(place, "holds another instance");
  }
  if (std::memcmp(&leaf.world_to_object, &instance.world_to_object, sizeof(Affine)) != 0) {
    return leaf_differs(place, "inverse transform differs from the captured one");
  }
  if (leaf.custom_index_and_mask >> 24 != (instance.mask & 0xff)) {
    return leaf_differs(place, "mask differs from the captured one");
  }
  if (decode_instance_flags(leaf.sbt_offset_and_flags) != (instance.flags & 0xf)) {
    return leaf_differs(place, "flags differ from the captured ones");
  }
  return "";
}

// The driver leaves out instances without structure and moves the others up; what remains at the
// end is unused.
std::string check_instances(const TreeView& tree, const TreeCheck& check, const Tlas& tlas) {
  const auto count = static_cast<std::uint32_t>(tlas.instances.size());
  std::uint32_t next = 0;  // instance expected in the next leaf, or one after it
  for (std::uint32_t leaf = 0; leaf < count; ++leaf) {
    const auto content = tree.read<InstanceLeaf>(tree.leaf_offset() + leaf * sizeof(InstanceLeaf));
    while (next < count && tlas.instances[next].blas == kNone && content.instance != next) {
      ++next;
    }
    if (next == count) {
      if (check.reached(leaf)) {
        return leaf_differs(leaf, "a box node leads to it, but there are no instances left");
      }
      continue;
    }
    const Instance& instance = tlas.instances[next];
    const std::string problem =
        instance.blas == kNone ? "" : check_instance(content, leaf, next, instance);
    if (!problem.empty()) {
      return problem;
    }
    if (instance.blas != kNone && !check.reached(leaf)) {
      return leaf_differs(leaf, "no box node leads to it");
    }
    ++next;
  }
  while (next < count && tlas.instances[next].blas == kNone) {
    ++next;
  }
  return next == count ? "" : "instance " + std::to_string(next) + " has no leaf";
}

}  // namespace

std::uint32_t encode_instance_flags(std::uint32_t flags) {
  return ((flags & kInstanceForceOpaque) != 0 ? kForceOpaque : 0) |
         ((flags & kInstanceForceNoOpaque) != 0 ? 0 : kNotForceNoOpaque) |
         ((flags & kInstanceCullDisable) != 0 ? kCullDisable : 0) |
         ((flags & kInstanceFlipFacing) != 0 ? kFlipFacing : 0);
}

std::uint32_t decode_instance_flags(std::uint32_t bits) {
  return ((bits & kForceOpaque) != 0 ? kInstanceForceOpaque : 0u) |
         ((bits & kNotForceNoOpaque) != 0 ? 0u : kInstanceForceNoOpaque) |
         ((bits & kCullDisable) != 0 ? kInstanceCullDisable : 0u) |
         ((bits & kFlipFacing) != 0 ? kInstanceFlipFacing : 0u);
}

std::string check_blas(std::span<const std::byte> nodes, const Blas& blas) {
  return blas.procedural()
             ? check_typed<AabbLeaf>(nodes, blas, NodeType::kAabb, blas.aabbs)
             : check_typed<TriangleLeaf>(nodes, blas, NodeType::kTriangle, blas.triangles);
}

std::string check_tlas(std::span<const std::byte> nodes, const Tlas& tlas) {
  const auto leaves = static_cast<std::uint32_t>(tlas.instances.size());
  std::string problem = check_sizes(nodes, leaves, sizeof(InstanceLeaf));
  if (!problem.empty() || leaves == 0) {
    return problem;
  }
  const TreeView tree(nodes);
  TreeCheck check(tree, leaves, NodeType::kInstance, sizeof(InstanceLeaf));
  problem = check.run();
  return problem.empty() ? check_instances(tree, check, tlas) : problem;
}

}  // namespace a2rt::driver
