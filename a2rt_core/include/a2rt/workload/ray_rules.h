// Which candidates a ray may see: opacity, masks and culling of the Vulkan specification (chapter
// "Ray Traversal"), in the driver's reading of it where the specification leaves room.
#pragma once

#include <cstdint>

#include "a2rt/workload/workload.h"

namespace a2rt {

// Whether no any-hit shader is asked. The ray's flags beat the instance's, those the geometry's.
inline bool is_opaque(bool geometry_opaque, std::uint32_t instance_flags, std::uint32_t ray_flags) {
  bool opaque = (geometry_opaque || (instance_flags & kInstanceForceOpaque) != 0) &&
                (instance_flags & kInstanceForceNoOpaque) == 0;
  opaque = (ray_flags & kRayOpaque) != 0 || opaque;
  return (ray_flags & kRayNoOpaque) == 0 && opaque;
}

inline bool culled_by_opacity(bool opaque, std::uint32_t ray_flags) {
  return (ray_flags & (opaque ? kRayCullOpaque : kRayCullNoOpaque)) != 0;
}

// gl_HitKindEXT of a triangle.
inline constexpr std::uint32_t kHitKindFront = 0xFE, kHitKindBack = 0xFF;

// Whether the ray sees the front of a triangle, after the instance's flip.
inline bool faces_front(bool determinant_positive, std::uint32_t instance_flags) {
  return determinant_positive != ((instance_flags & kInstanceFlipFacing) != 0);
}

inline bool culled_by_facing(bool front, std::uint32_t instance_flags, std::uint32_t ray_flags) {
  return (instance_flags & kInstanceCullDisable) == 0 &&
         (ray_flags & (front ? kRayCullFrontFacing : kRayCullBackFacing)) != 0;
}

inline bool masked_out(std::uint32_t instance_mask, std::uint32_t ray_mask) {
  return (instance_mask & ray_mask & 0xff) == 0;
}

// Intervals: a triangle is hit strictly inside (tmin, tmax), a reported intersection also at the
// ends, where tmax is the nearest accepted hit so far.
inline bool triangle_in_range(float t, float tmin, float tmax) { return t < tmax && tmin < t; }
inline bool report_in_range(float t, float tmin, float tmax) { return t >= tmin && tmax >= t; }

}  // namespace a2rt
