// World boxes of instances that no ray can slip past.
//
// A unit tests the world ray against the instance's world box, and later the ray that the driver
// transformed in FP32 against object-space boxes. The two rays differ by rounding, so the world box
// must hold every world point whose transformed image, with its rounding error, can lie in the
// object box.
//
// Bound. Let M x + m be the driver's world-to-object map (its bits, taken as exact). The FP32 ray
// satisfies o' = M o + m + e0 and d' = M d + e1 with |e0| <= 8u (|M||o| + |m|) and
// |e1| <= 8u |M||d| (at most four roundings each, u = 2^-24, doubled), plus underflow. A hit at t
// has p' = o' + t d' in the object box, hence the world point p = o + t d obeys
//   M p + m = p' - e,  |e| <= 8u (|M| (|o| + t|d|) + |m|),  t|d| <= |p| + |o| per axis.
// So p lies in the map of the object box grown by |e| through the exact inverse of M. |o| is
// bounded by the rays of the workload, which is why they are an argument.
#pragma once

#include <span>
#include <vector>

#include "a2rt/base/vec.h"
#include "a2rt/workload/workload.h"

namespace a2rt::bvh {

// Largest |origin| per axis over a set of finite rays, and the smallest max-norm of a non-zero
// direction (both enter the bound above).
struct RayReach {
  Vec3 origin;
  float shortest_direction = 1;
};
// Reach of the rays that are traced into TLAS `tlas`.
RayReach ray_reach(std::span<const Ray> rays, std::uint32_t tlas);

// Boxes without a bound reach at least as far. Extents of boxes up to here are finite in FP32,
// which some encodings need.
inline constexpr float kUnboundedReach = 0x1p126F;

// Box for instances without a bound: the world points that a singular map takes into the object
// box reach infinitely far, and for nearly singular ones the bound does not converge. Twice as far
// as any ray or object, with finite extents, or all of FP32 if these reach beyond 2^125.
Box unbounded_box(const RayReach& reach, const Box& object_box);

// World box of one instance; empty if it cannot be hit: no BLAS, an empty BLAS, or a map with a
// NaN or an infinity (the object ray is then inactive).
Box instance_world_box(const Instance& instance, const Box& object_box, const RayReach& reach);

}  // namespace a2rt::bvh
