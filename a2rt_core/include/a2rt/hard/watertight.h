// Watertightness: rays aimed exactly at the vertices and edges of closed surfaces.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/hard/judge.h"
#include "a2rt/workload/workload.h"

namespace a2rt::hard {

// A closed surface and rays that start inside it: each must hit.
struct ClosedMesh {
  std::string key, title;
  Workload (*make)(std::uint32_t origins);  // rays from that many points inside
};
const std::vector<ClosedMesh>& closed_meshes();

struct Leaks {
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;           // rays that brute force says hit
  std::uint64_t leaked = 0;         // of these: the unit finds nothing
  std::uint64_t farther = 0;        // of these: the unit finds a later hit (scenes only)
  std::uint64_t rounding_ties = 0;  // later hits that no unit owes, see Cell (scenes only)
  std::uint64_t missed = 0;         // box decisions that exact arithmetic contradicts (scenes only)
};

// Every ray of a ClosedMesh's workload hits; what the unit does not hit leaks.
Leaks count_leaks(const UnitColumn& column, const Workload& closed);

// Replaces the rays of a captured workload by rays from the origins of its primary rays to
// vertices and edge points of its triangles, or, of procedural geometry, of its boxes.
Workload aim_at_edges(const Workload& captured, std::uint32_t rays, std::uint64_t seed);
// `truth`: true_hits(aimed).
Leaks count_leaks(const UnitColumn& column, const Workload& aimed, const std::vector<Hit>& truth);

}  // namespace a2rt::hard
