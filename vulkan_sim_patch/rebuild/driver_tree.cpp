#include "rebuild/driver_tree.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "rebuild/bvh_builder.h"

namespace a2rt::layer {
namespace {

std::size_t leaf_bytes(LeafKind kind) {
  switch (kind) {
    case LeafKind::kTriangle:
      return sizeof(DriverTriangle);
    case LeafKind::kAabb:
      return sizeof(DriverAabb);
    case LeafKind::kInstance:
      break;
  }
  return sizeof(DriverInstance);
}

std::uint32_t box_nodes(std::uint32_t slots) { return std::max(slots, 2u) - 1; }

std::uint64_t expected_leaf_offset(std::uint32_t slots) {
  return sizeof(DriverHeader) + std::uint64_t{sizeof(DriverBoxNode)} * box_nodes(slots);
}

std::uint32_t type_of(std::uint32_t id) { return id & 3u; }
std::uint32_t offset_of(std::uint32_t id) { return id & ~3u; }

// Walks the box nodes from the root and checks that they are a tree over `leaves` leaves.
class TreeWalk {
 public:
  TreeWalk(const std::byte* base, LeafKind kind, std::uint32_t slots, std::uint32_t leaves)
      : base_(base), kind_(kind), slots_(slots), leaves_(leaves), seen_(leaves) {}

  bool run(std::string& why) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> stack = {
        {static_cast<std::uint32_t>(sizeof(DriverHeader)) | kBoxNodeType, 1}};
    std::uint32_t boxes = 0;
    while (!stack.empty()) {
      const auto [id, depth] = stack.back();
      stack.pop_back();
      if (id == kNoChild) {
        continue;
      }
      if (type_of(id) != kBoxNodeType) {
        if (!visit_leaf(id, why)) {
          return false;
        }
        continue;
      }
      const std::uint32_t offset = offset_of(id) - static_cast<std::uint32_t>(sizeof(DriverHeader));
      if (offset_of(id) < sizeof(DriverHeader) || offset % sizeof(DriverBoxNode) != 0 ||
          offset / sizeof(DriverBoxNode) >= box_nodes(slots_) || ++boxes > box_nodes(slots_)) {
        why = "a box node's child lies outside the box nodes";
        return false;
      }
      depth_ = std::max(depth_, depth);
      DriverBoxNode node;
      std::memcpy(&node, base_ + offset_of(id), sizeof(node));
      stack.emplace_back(node.children[0], depth + 1);
      stack.emplace_back(node.children[1], depth + 1);
    }
    if (visited_ != leaves_) {
      why = "the tree reaches " + std::to_string(visited_) + " of " + std::to_string(leaves_) +
            " leaves";
      return false;
    }
    return true;
  }

  std::uint32_t depth() const { return depth_; }

 private:
  bool visit_leaf(std::uint32_t id, std::string& why) {
    const std::uint64_t first = expected_leaf_offset(slots_);
    const std::uint64_t offset = offset_of(id);
    if (type_of(id) != static_cast<std::uint32_t>(kind_) || offset < first ||
        (offset - first) % leaf_bytes(kind_) != 0 ||
        (offset - first) / leaf_bytes(kind_) >= leaves_) {
      why = "a leaf has an unexpected type or place";
      return false;
    }
    const auto leaf = static_cast<std::size_t>((offset - first) / leaf_bytes(kind_));
    if (seen_[leaf]) {
      why = "a leaf is reached twice";
      return false;
    }
    seen_[leaf] = true;
    ++visited_;
    return true;
  }

  const std::byte* base_;
  LeafKind kind_;
  std::uint32_t slots_;
  std::uint32_t leaves_;
  std::vector<bool> seen_;
  std::uint32_t visited_ = 0;
  std::uint32_t depth_ = 0;
};

std::uint32_t used_leaves(const DriverHeader& header, LeafKind kind, std::uint32_t slots) {
  return kind == LeafKind::kInstance ? header.instance_count : slots;
}

}  // namespace

bool DriverTree::matches(const void* structure, LeafKind kind, std::uint32_t slots,
                         std::string& why) {
  if (slots == 0) {
    why = "it is empty";
    return false;
  }
  const auto* base = static_cast<const std::byte*>(structure);
  DriverHeader header;
  std::memcpy(&header, base, sizeof(header));
  if (header.leaf_nodes_offset != expected_leaf_offset(slots)) {
    why = "its leaves begin at byte " + std::to_string(header.leaf_nodes_offset) + ", expected " +
          std::to_string(expected_leaf_offset(slots));
    return false;
  }
  const std::uint32_t leaves = used_leaves(header, kind, slots);
  if (leaves > slots) {
    why = "its header counts more instances than were built";
    return false;
  }
  return TreeWalk(base, kind, slots, leaves).run(why);
}

DriverTree::DriverTree(void* structure, LeafKind kind, std::uint32_t slots)
    : base_(static_cast<std::byte*>(structure)), kind_(kind), slots_(slots) {}

std::uint32_t DriverTree::leaves() const { return used_leaves(header(), kind_, slots_); }

std::size_t DriverTree::bytes() const {
  return header().leaf_nodes_offset + std::size_t{slots_} * leaf_bytes(kind_);
}

std::span<const DriverTriangle> DriverTree::triangles() const {
  return {reinterpret_cast<const DriverTriangle*>(leaf_memory()), leaves()};
}

std::span<const DriverAabb> DriverTree::aabbs() const {
  return {reinterpret_cast<const DriverAabb*>(leaf_memory()), leaves()};
}

std::span<const DriverInstance> DriverTree::instances() const {
  return {reinterpret_cast<const DriverInstance*>(leaf_memory()), leaves()};
}

DriverBox DriverTree::leaf_box(std::uint32_t leaf) const {
  DriverBox box{};
  switch (kind_) {
    case LeafKind::kAabb:
      return aabbs()[leaf].bounds;
    case LeafKind::kTriangle: {
      const float* v = triangles()[leaf].vertices;
      for (int axis = 0; axis < 3; ++axis) {
        box.lo[axis] = std::min({v[axis], v[3 + axis], v[6 + axis]});
        box.hi[axis] = std::max({v[axis], v[3 + axis], v[6 + axis]});
      }
      return box;
    }
    case LeafKind::kInstance:
      break;
  }
  const DriverInstance& instance = instances()[leaf];
  DriverBox object{};
  std::memcpy(&object, reinterpret_cast<const void*>(instance.structure), sizeof(object));
  for (int axis = 0; axis < 3; ++axis) {
    const float* row = instance.object_to_world[axis];
    box.lo[axis] = row[3];
    box.hi[axis] = row[3];
    for (int k = 0; k < 3; ++k) {
      // The order of the operations is the driver's, so that the boxes are the same to the bit.
      const float a = row[k] * object.lo[k];
      const float b = row[k] * object.hi[k];
      box.lo[axis] += a < b ? a : b;
      box.hi[axis] += a > b ? a : b;
    }
  }
  return box;
}

std::uint32_t DriverTree::depth() const {
  TreeWalk walk(base_, kind_, slots_, leaves());
  std::string why;
  walk.run(why);
  return walk.depth();
}

std::uint32_t DriverTree::reachable_leaves() const {
  std::uint32_t count = 0;
  std::vector<std::uint32_t> stack = {static_cast<std::uint32_t>(sizeof(DriverHeader))};
  while (!stack.empty()) {
    DriverBoxNode node;
    std::memcpy(&node, base_ + stack.back(), sizeof(node));
    stack.pop_back();
    for (std::size_t i = 0; i < 2; ++i) {
      const std::uint32_t id = node.children[i];
      if (id == kNoChild || std::isnan(node.bounds[i].lo[0])) {
        continue;
      }
      if (type_of(id) == kBoxNodeType) {
        stack.push_back(offset_of(id));
      } else {
        ++count;
      }
    }
  }
  return count;
}

bool DriverTree::rebuild(std::uint32_t depth_limit, unsigned threads, std::string& why) {
  std::vector<BuildItem> items;
  items.reserve(leaves());
  for (std::uint32_t leaf = 0; leaf < leaves(); ++leaf) {
    const DriverBox box = leaf_box(leaf);
    bool whole = true;
    for (int axis = 0; axis < 3; ++axis) {
      whole = whole && !std::isnan(box.lo[axis]) && !std::isnan(box.hi[axis]);
    }
    bool inactive = std::isnan(box.lo[0]);
    if (kind_ == LeafKind::kTriangle) {
      // std::min hides a NaN; lavapipe's triangle test accepts no triangle that has one.
      const float* v = triangles()[leaf].vertices;
      inactive = std::any_of(v, v + 9, [](float x) { return std::isnan(x); });
    }
    if (inactive) {
      continue;
    }
    if (!whole) {
      why = "leaf " + std::to_string(leaf) + " has a box with NaN";
      return false;
    }
    items.push_back({box, leaf});
  }
  if (items.size() < 3) {
    why = "it has fewer than three active leaves";
    return false;
  }
  if (items.size() < leaves() && reachable_leaves() < items.size()) {
    // The rebuilt tree would show what the driver loses; the picture must stay the program's own.
    why = "beside inactive primitives the driver itself loses active ones (" +
          std::to_string(items.size() - reachable_leaves()) + " of " +
          std::to_string(items.size()) + ")";
    return false;
  }
  if (depth_needed(items.size()) > depth_limit) {
    why = "a tree over " + std::to_string(items.size()) + " leaves is deeper than " +
          std::to_string(depth_limit) + " levels, all that the driver's stack leaves for it";
    return false;
  }
  const TreeTarget target{reinterpret_cast<DriverBoxNode*>(base_ + sizeof(DriverHeader)),
                          static_cast<std::uint32_t>(sizeof(DriverHeader)),
                          header().leaf_nodes_offset, static_cast<std::uint32_t>(leaf_bytes(kind_)),
                          static_cast<std::uint32_t>(kind_)};
  build_sah(items, target, depth_limit, threads);
  return true;
}

}  // namespace a2rt::layer
