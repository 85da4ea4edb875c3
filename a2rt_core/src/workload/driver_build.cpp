// Trees in the driver's layout for workloads that never met the driver.
#include <algorithm>
#include <numeric>

#include "a2rt/base/error.h"
#include "a2rt/workload/driver_triangle.h"
#include "driver_tree.h"

namespace a2rt::driver {
namespace {

class Builder {
 public:
  Builder(const std::vector<Box>& boxes, NodeType leaf_type, std::size_t leaf_bytes)
      : boxes_(boxes),
        leaf_type_(leaf_type),
        leaf_bytes_(leaf_bytes),
        leaf_offset_(sizeof(Header) + box_nodes(count()) * sizeof(BoxNode)),
        bytes_(leaf_offset_ + boxes.size() * leaf_bytes),
        order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
  }

  std::vector<std::byte> build() {
    Box bounds;
    if (count() > 1) {
      box_node(0, count(), bounds);
    } else {
      BoxNode only{};
      only.children[0] = only.children[1] = kInvalidNode;
      if (count() == 1) {
        only.children[0] = child(0, 1, only.bounds[0]);
        bounds = only.bounds[0];
      }
      write(sizeof(Header), only);
    }
    const auto size = static_cast<std::uint32_t>(bytes_.size());
    write(0, Header{bounds, size, 0, static_cast<std::uint32_t>(leaf_offset_), 0});
    return std::move(bytes_);
  }
  template <class Leaf>
  void leaf(std::size_t index, const Leaf& content) {
    write(leaf_offset_ + index * leaf_bytes_, content);
  }

 private:
  std::uint32_t count() const { return static_cast<std::uint32_t>(boxes_.size()); }

  template <class T>
  void write(std::size_t offset, const T& value) {
    std::memcpy(bytes_.data() + offset, &value, sizeof value);
  }
  std::uint32_t child(std::uint32_t first, std::uint32_t last, Box& bounds) {
    if (last - first == 1) {
      bounds = boxes_[order_[first]];
      return static_cast<std::uint32_t>(leaf_offset_ + order_[first] * leaf_bytes_) |
             static_cast<std::uint32_t>(leaf_type_);
    }
    return box_node(first, last, bounds);
  }
  std::uint32_t box_node(std::uint32_t first, std::uint32_t last, Box& bounds) {
    const std::size_t offset = sizeof(Header) + next_++ * sizeof(BoxNode);
    const std::uint32_t middle = split(first, last);
    BoxNode node{};
    node.children[0] = child(first, middle, node.bounds[0]);
    node.children[1] = child(middle, last, node.bounds[1]);
    bounds.include(node.bounds[0]);
    bounds.include(node.bounds[1]);
    write(offset, node);
    return static_cast<std::uint32_t>(offset) | static_cast<std::uint32_t>(NodeType::kBox);
  }
  std::uint32_t split(std::uint32_t first, std::uint32_t last) {
    const auto twice_centre = [&](std::uint32_t i, std::size_t axis) {
      return boxes_[i].lo[axis] + boxes_[i].hi[axis];
    };
    Box centres;
    for (std::uint32_t i = first; i < last; ++i) {
      centres.include(
          Vec3{twice_centre(order_[i], 0), twice_centre(order_[i], 1), twice_centre(order_[i], 2)});
    }
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a) {
      axis = centres.hi[a] - centres.lo[a] > centres.hi[axis] - centres.lo[axis] ? a : axis;
    }
    const std::uint32_t middle = first + (last - first) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                     [&](std::uint32_t a, std::uint32_t b) {
                       const float ca = twice_centre(a, axis), cb = twice_centre(b, axis);
                       return ca < cb || (ca == cb && a < b);
                     });
    return middle;
  }

  const std::vector<Box>& boxes_;
  NodeType leaf_type_;
  std::size_t leaf_bytes_, leaf_offset_, next_ = 0;
  std::vector<std::byte> bytes_;
  std::vector<std::uint32_t> order_;
};

Box box_of(const Triangle& t) {
  Box box;
  for (const Vec3& v : t.v) {
    box.include(v);
  }
  return box;
}

std::uint32_t geometry_word(const Geometry& geometry, std::uint32_t index) {
  return index | (geometry.opaque ? kGeometryOpaque : 0u);
}

Box bounds_of(const Blas& blas) {
  Box bounds;
  for (const Triangle& t : blas.triangles) {
    bounds.include(box_of(t));
  }
  for (const Box& b : blas.aabbs) {
    bounds.include(b);
  }
  return bounds;
}

// World box of a transformed object-space box.
Box transformed(const Box& box, const Affine& map) {
  Box world;
  for (unsigned corner = 0; corner < 8; ++corner) {
    world.include(driver_transform_point(
        map, {(corner & 1) != 0 ? box.hi.x : box.lo.x, (corner & 2) != 0 ? box.hi.y : box.lo.y,
              (corner & 4) != 0 ? box.hi.z : box.lo.z}));
  }
  return world;
}

}  // namespace

std::vector<std::byte> build_blas(const Blas& blas) {
  const bool procedural = blas.procedural();
  std::vector<Box> boxes = blas.aabbs;
  for (const Triangle& t : blas.triangles) {
    boxes.push_back(box_of(t));
  }
  Builder builder(boxes, procedural ? NodeType::kAabb : NodeType::kTriangle,
                  procedural ? sizeof(AabbLeaf) : sizeof(TriangleLeaf));
  for (std::uint32_t g = 0; g < blas.geometries.size(); ++g) {
    const Geometry& geometry = blas.geometries[g];
    for (std::uint32_t p = 0; p < geometry.count; ++p) {
      const std::uint32_t slot = geometry.first + p;
      if (procedural) {
        builder.leaf(slot, AabbLeaf{blas.aabbs[slot], p, geometry_word(geometry, g)});
      } else {
        builder.leaf(slot, TriangleLeaf{blas.triangles[slot], 0, p, geometry_word(geometry, g)});
      }
    }
  }
  return builder.build();
}

std::vector<std::byte> build_tlas(const Tlas& tlas, const std::vector<Blas>& blas) {
  std::vector<Box> boxes;
  for (const Instance& instance : tlas.instances) {
    A2RT_CHECK(instance.blas != kNone, "synthetic instances are active");
    boxes.push_back(transformed(bounds_of(blas[instance.blas]), instance.object_to_world));
  }
  Builder builder(boxes, NodeType::kInstance, sizeof(InstanceLeaf));
  for (std::uint32_t i = 0; i < tlas.instances.size(); ++i) {
    const Instance& instance = tlas.instances[i];
    builder.leaf(i, InstanceLeaf{{instance.blas, 0},
                                 instance.custom_index | instance.mask << 24,
                                 instance.sbt_offset | encode_instance_flags(instance.flags),
                                 instance.world_to_object,
                                 0,
                                 i,
                                 instance.object_to_world});
  }
  return builder.build();
}

}  // namespace a2rt::driver
