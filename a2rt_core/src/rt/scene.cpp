#include "a2rt/rt/scene.h"

#include <algorithm>
#include <string>

#include "a2rt/base/error.h"

namespace a2rt::rt {
namespace {

// Geometry and primitive of every primitive slot of a BLAS, found by walking the geometries once.
std::vector<PrimitiveId> slot_ids(const Blas& blas) {
  std::vector<PrimitiveId> ids(blas.primitive_count());
  for (std::uint32_t g = 0; g < blas.geometries.size(); ++g) {
    const Geometry& geometry = blas.geometries[g];
    if (std::uint64_t{geometry.first} + geometry.count > ids.size()) {
      throw UserError("geometry " + std::to_string(g) + " names primitives " +
                      std::to_string(geometry.first) + " + " + std::to_string(geometry.count) +
                      ", but its BLAS has " + std::to_string(ids.size()) +
                      "; the workload file is damaged");
    }
    for (std::uint32_t p = 0; p < geometry.count; ++p) {
      ids[geometry.first + p] = {g | (geometry.opaque ? 1U << 31 : 0U), p};
    }
  }
  return ids;
}

}  // namespace

Primitives arrange_primitives(const Blas& blas, const bvh::WideBvh& bvh,
                              const LayoutSettings& layout, bvh::AddressSpace& space,
                              const std::string& name) {
  Primitives result;
  result.procedural = blas.procedural();
  const std::vector<PrimitiveId> ids = slot_ids(blas);
  const std::size_t n = bvh.order.size();
  result.ids.reserve(n);
  for (const std::uint32_t slot : bvh.order) {
    result.ids.push_back(ids[slot]);
  }
  if (result.procedural) {
    result.aabbs.reserve(n);
    for (const std::uint32_t slot : bvh.order) {
      result.aabbs.push_back(blas.aabbs[slot]);
    }
    result.data = space.reserve(name + " AABBs", Bytes{n * sizeof(Box)});
  } else {
    result.triangles.reserve(n + 1);
    for (const std::uint32_t slot : bvh.order) {
      result.triangles.emplace_back(blas.triangles[slot]);
    }
    result.triangles.emplace_back();
    if (layout.mesh_order) {
      result.mesh_slots = bvh.order;
    }
    result.data =
        space.reserve(name + " triangles",
                      Bytes{(layout.mesh_order ? blas.triangles.size() : n) * sizeof(Triangle)});
  }
  result.id_data = space.reserve(name + " ids", Bytes{n * layout.id_bytes});
  return result;
}

SceneTop arrange_instances(const Tlas& tlas, const bvh::WideBvh& bvh, const LayoutSettings& layout,
                           bvh::AddressSpace& space, const std::string& name) {
  SceneTop top;
  top.order = bvh.order;
  const Address base = space.reserve(
      name + " instances", Bytes{std::uint64_t{tlas.instances.size()} * layout.instance_bytes});
  for (std::size_t i = 0; i < tlas.instances.size(); ++i) {
    const Instance& instance = tlas.instances[i];
    top.instances.push_back({instance.world_to_object, instance.blas, instance.mask, instance.flags,
                             base + Bytes{i * layout.instance_bytes},
                             instance.world_to_object == Affine{}});
  }
  return top;
}

}  // namespace a2rt::rt
