// What every unit has in memory besides its nodes: primitives in leaf order, ids, instances.
//
// Records and sizes: triangle 36 bytes (nine FP32, no ids), AABB 24, ids 8 (geometry, primitive; a
// separate array, read when a hit or candidate is reported), instance 64. Whether a geometry is
// opaque is part of the leaf's reference, so the opaque test reads nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "a2rt/base/huge_vector.h"
#include "a2rt/base/units.h"
#include "a2rt/bvh/address_space.h"
#include "a2rt/bvh/wide_bvh.h"
#include "a2rt/rt/fast_triangle.h"
#include "a2rt/rt/settings.h"
#include "a2rt/workload/workload.h"

namespace a2rt::rt {

// Ids of one primitive slot.
struct PrimitiveId {
  std::uint32_t geometry_and_opaque = 0;  // bit 31: opaque
  std::uint32_t primitive = 0;
  std::uint32_t geometry() const { return geometry_and_opaque & 0x7fffffffU; }
  bool opaque() const { return (geometry_and_opaque >> 31) != 0; }
};

struct Primitives {
  // Leaf order, and one more that the vector code may read; empty for procedural geometry.
  HugeVector<AxisTriangle> triangles;
  std::vector<Box> aabbs;       // leaf order
  HugeVector<PrimitiveId> ids;  // leaf order
  Address data, id_data;        // of slot 0
  // Slot in mesh order per leaf slot; only where triangles are charged in mesh order.
  std::vector<std::uint32_t> mesh_slots;
  bool procedural = false;
};

struct InstanceRecord {
  Affine world_to_object;
  std::uint32_t blas = 0;
  std::uint32_t mask = 0;
  std::uint32_t flags = 0;
  Address address;
  bool identity = false;  // its rays are the world's rays: nothing to transform
};

struct SceneTop {
  std::vector<InstanceRecord> instances;  // by instance index
  std::vector<std::uint32_t> order;       // leaf order of the TLAS
};

// Copies a BLAS's primitives into the leaf order of `bvh` and reserves their addresses.
Primitives arrange_primitives(const Blas& blas, const bvh::WideBvh& bvh,
                              const LayoutSettings& layout, bvh::AddressSpace& space,
                              const std::string& name);
SceneTop arrange_instances(const Tlas& tlas, const bvh::WideBvh& bvh, const LayoutSettings& layout,
                           bvh::AddressSpace& space, const std::string& name);

}  // namespace a2rt::rt
