// The acceleration structure as lavapipe (Mesa 25.0) keeps it in memory, behind checks.
//
// Layout: header, box nodes, leaves. A node id is byte offset | type, relative to the header. The
// root is the first box node. Nothing here is promised by Mesa: open() verifies what it relies on
// and says why if something differs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace a2rt::layer {

struct DriverBox {
  float lo[3];
  float hi[3];
};

struct DriverHeader {
  DriverBox bounds;
  std::uint32_t serialization_size;
  std::uint32_t instance_count;
  std::uint32_t leaf_nodes_offset;
  std::uint32_t padding;
};
static_assert(sizeof(DriverHeader) == 40);

struct DriverBoxNode {
  DriverBox bounds[2];
  std::uint32_t children[2];
};
static_assert(sizeof(DriverBoxNode) == 56);

struct DriverTriangle {
  float vertices[9];
  std::uint32_t padding;
  std::uint32_t primitive;
  std::uint32_t geometry_and_flags;
};
static_assert(sizeof(DriverTriangle) == 48);

struct DriverAabb {
  DriverBox bounds;
  std::uint32_t primitive;
  std::uint32_t geometry_and_flags;
};
static_assert(sizeof(DriverAabb) == 32);

struct DriverInstance {
  std::uint64_t structure;
  std::uint32_t custom_index_and_mask;
  std::uint32_t sbt_offset_and_flags;
  float world_to_object[3][4];
  std::uint32_t padding;
  std::uint32_t instance;
  float object_to_world[3][4];
};
static_assert(sizeof(DriverInstance) == 120);

enum class LeafKind : std::uint32_t { kTriangle = 0, kInstance = 2, kAabb = 3 };
inline constexpr std::uint32_t kBoxNodeType = 1;
inline constexpr std::uint32_t kNoChild = 0xffffffffu;

class DriverTree {
 public:
  // `slots`: primitives or instances of the build, inactive ones included. On failure `why` says
  // which assumption did not hold.
  static bool matches(const void* structure, LeafKind kind, std::uint32_t slots, std::string& why);

  // Precondition: matches().
  DriverTree(void* structure, LeafKind kind, std::uint32_t slots);

  std::uint32_t slots() const { return slots_; }
  // Leaves in use: the driver leaves inactive instances out and packs the others.
  std::uint32_t leaves() const;
  std::size_t bytes() const;
  std::span<const std::byte> memory() const { return {base_, bytes()}; }
  std::span<const DriverTriangle> triangles() const;
  std::span<const DriverAabb> aabbs() const;
  std::span<const DriverInstance> instances() const;
  // The box the driver gives a leaf, computed as the driver does.
  DriverBox leaf_box(std::uint32_t leaf) const;
  // Longest path from the root, in box nodes.
  std::uint32_t depth() const;

  // Leaves that rays can reach. lavapipe enters no box whose lower x is NaN, and a box beside an
  // inactive primitive can inherit its NaN: active primitives under it are lost.
  std::uint32_t reachable_leaves() const;

  // Replaces the box nodes by a SAH tree over the same leaves (see bvh_builder.h). Returns false
  // and says why if the tree must stay as it is.
  bool rebuild(std::uint32_t depth_limit, unsigned threads, std::string& why);

 private:
  DriverHeader& header() const { return *reinterpret_cast<DriverHeader*>(base_); }
  std::byte* leaf_memory() const { return base_ + header().leaf_nodes_offset; }

  std::byte* base_;
  LeafKind kind_;
  std::uint32_t slots_;
};

}  // namespace a2rt::layer
