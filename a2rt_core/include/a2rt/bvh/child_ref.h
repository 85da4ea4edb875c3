// How a traversal names a child: an inner node, or a range of primitives, in 32 bits.
#pragma once

#include <cstdint>
#include <string>

#include "a2rt/base/error.h"
#include "a2rt/bvh/wide_bvh.h"

namespace a2rt::bvh {

class ChildRef {
 public:
  static constexpr std::uint32_t kMostInner = (1U << 30) - 1;
  static constexpr std::uint32_t kMostFirst = (1U << 27) - 1;

  ChildRef() = default;  // indeterminate, so that a traversal's stack costs nothing to make
  // `opens`: entering the node starts a new frame (A2RT group, AQB8 cluster).
  static ChildRef inner(std::uint32_t index, bool opens) {
    A2RT_CHECK(index <= kMostInner, "a tree has more than 2^30 inner nodes");
    return ChildRef((opens ? kOpens : 0U) | index);
  }
  static ChildRef leaf(std::uint32_t first, std::uint32_t count) {
    if (first > kMostFirst) {
      throw UserError("a structure has more than 2^27 primitives; split it into several");
    }
    A2RT_CHECK(count >= 1 && count <= kMaxLeaf, "leaf of " + std::to_string(count));
    return ChildRef(kLeaf | (count - 1) << 27 | first);
  }
  constexpr bool is_leaf() const { return (bits_ & kLeaf) != 0; }
  // Inner nodes only.
  constexpr bool opens() const { return (bits_ & (kLeaf | kOpens)) == kOpens; }
  constexpr std::uint32_t index() const { return bits_ & kMostInner; }
  // Leaves only: slots of the leaf order.
  constexpr std::uint32_t first() const { return bits_ & kMostFirst; }
  constexpr std::uint32_t count() const { return ((bits_ >> 27) & 15U) + 1; }
  friend constexpr bool operator==(ChildRef, ChildRef) = default;

 private:
  static constexpr std::uint32_t kLeaf = 1U << 31, kOpens = 1U << 30;
  explicit constexpr ChildRef(std::uint32_t bits) : bits_(bits) {}
  std::uint32_t bits_;
};
static_assert(sizeof(ChildRef) == 4);

}  // namespace a2rt::bvh
