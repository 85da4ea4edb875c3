// Reading a tree in the driver's layout without assuming alignment.
#pragma once

#include <cstring>
#include <span>

#include "a2rt/workload/driver_layout.h"

namespace a2rt::driver {

inline std::size_t box_nodes(std::uint32_t leaves) { return leaves > 1 ? leaves - 1 : 1; }

class TreeView {
 public:
  explicit TreeView(std::span<const std::byte> bytes) : bytes_(bytes) {}

  // The caller has checked that the node lies inside (check_blas, check_tlas).
  template <class Node>
  Node read(std::size_t offset) const {
    Node node;
    std::memcpy(static_cast<void*>(&node), bytes_.data() + offset, sizeof node);
    return node;
  }
  std::uint32_t leaf_offset() const { return read<Header>(0).leaf_offset; }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace a2rt::driver
