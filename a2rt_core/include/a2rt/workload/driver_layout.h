// Where lavapipe of Mesa 25.0 keeps its trees: header, box nodes, leaves, all in one buffer.
//
// A node reference is a byte offset from the header with the node's type in its two low bits. n
// leaves have max(1, n - 1) box nodes; the root is the first of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "a2rt/base/vec.h"
#include "a2rt/workload/workload.h"

namespace a2rt::driver {

enum class NodeType : std::uint32_t { kTriangle = 0, kBox = 1, kInstance = 2, kAabb = 3 };
inline constexpr std::uint32_t kInvalidNode = 0xffffffffu;
inline constexpr std::uint32_t kStackEntries = 48;

struct Header {
  Box bounds;
  std::uint32_t serialization_size, instance_count, leaf_offset, padding;
};
struct BoxNode {
  Box bounds[2];
  std::uint32_t children[2];
};
struct TriangleLeaf {
  Triangle triangle;
  std::uint32_t padding, primitive, geometry_and_flags;
};
struct AabbLeaf {
  Box bounds;
  std::uint32_t primitive, geometry_and_flags;
};
struct InstanceLeaf {
  std::uint32_t blas_address[2];
  std::uint32_t custom_index_and_mask;
  std::uint32_t sbt_offset_and_flags;  // flags in the driver's own encoding, bits 28..31
  Affine world_to_object;
  std::uint32_t padding, instance;
  Affine object_to_world;
};
static_assert(sizeof(Header) == 40 && sizeof(BoxNode) == 56 && sizeof(TriangleLeaf) == 48);
static_assert(sizeof(AabbLeaf) == 32 && sizeof(InstanceLeaf) == 120);

inline constexpr std::uint32_t kRoot =
    static_cast<std::uint32_t>(sizeof(Header)) | static_cast<std::uint32_t>(NodeType::kBox);
inline constexpr std::uint32_t kGeometryOpaque = 1u << 31;
inline constexpr std::uint32_t kGeometryIndexMask = 0x0fffffffu;

// Instance flags as the driver keeps them. Bit 30 is set unless opacity is forced off.
std::uint32_t encode_instance_flags(std::uint32_t vulkan_flags);
std::uint32_t decode_instance_flags(std::uint32_t sbt_offset_and_flags);

// Layout guards: empty if `nodes` is a tree of this layout over exactly the given content, or the
// sentence that says what differs. References, depth and every leaf's content are checked, so that
// a walk over accepted nodes stays inside the buffer.
std::string check_blas(std::span<const std::byte> nodes, const Blas& blas);
std::string check_tlas(std::span<const std::byte> nodes, const Tlas& tlas);

// Builds such a tree by splitting at the middle of the longest axis (for synthetic workloads).
std::vector<std::byte> build_blas(const Blas& blas);
std::vector<std::byte> build_tlas(const Tlas& tlas, const std::vector<Blas>& blas);

}  // namespace a2rt::driver
