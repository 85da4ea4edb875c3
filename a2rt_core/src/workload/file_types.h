// The rows of a workload file. Where a row equals a struct of workload.h it is written as that.
#pragma once

#include <cstdint>

#include "a2rt/workload/workload.h"
#include "hdf5.h"

namespace a2rt::file {

inline constexpr const char* kFormatName = "a2rt-workload";

struct BlasRow {
  std::uint64_t first_triangle, first_aabb, first_geometry, first_node_byte, node_bytes;
  std::uint32_t triangles, aabbs, geometries, reserved;
};
struct GeometryRow {
  std::uint32_t first, count, opaque;
};
struct TlasRow {
  std::uint64_t first_instance, first_node_byte, node_bytes;
  std::uint32_t instances, reserved;
};
inline constexpr std::size_t kEntryBytes = 64;
struct ShaderRow {
  std::uint64_t hash;
  std::uint32_t stage, reserved;
  char entry[kEntryBytes];  // cut off if longer
};

// HDF5 types of all rows, by what they hold.
struct Types {
  Types();
  h5::Handle vec3, corners, map, counts, entry;
  h5::Handle triangle, box, geometry, blas, instance, tlas, dispatch, shader, ray, hit, candidate,
      segment;
};

// Checksum that stands before the HDF5 part of the file, in its user block.
inline constexpr std::uint64_t kUserBlockBytes = 512;
inline constexpr char kMagic[8] = {'A', '2', 'R', 'T', 'W', 'K', 'L', 'D'};
struct UserBlock {
  char magic[8];
  std::uint32_t version, reserved;
  std::uint64_t payload_bytes;
  std::uint64_t payload_hash;
};
static_assert(sizeof(UserBlock) == 32);

// 64-bit hash for finding damage, not forgery; about one multiplication per eight bytes.
std::uint64_t hash_bytes(const std::byte* data, std::size_t bytes);

}  // namespace a2rt::file
