#include "file_types.h"

#include <bit>
#include <cstddef>
#include <cstring>

namespace a2rt::file {
namespace {

h5::Handle fixed_text(std::size_t bytes) {
  h5::Handle type{H5Tcopy(H5T_C_S1), H5Tclose};
  H5Tset_size(type.id(), bytes);
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  return type;
}

// Functions, because HDF5's type names open the library when they are read.
hid_t f32() { return H5T_IEEE_F32LE; }
hid_t u32() { return H5T_STD_U32LE; }
hid_t u64() { return H5T_STD_U64LE; }

}  // namespace

Types::Types()
    : vec3(h5::array_type(f32(), {3})),
      corners(h5::array_type(f32(), {3, 3})),
      map(h5::array_type(f32(), {3, 4})),
      counts(h5::array_type(u32(), {8})),
      entry(fixed_text(kEntryBytes)),
      triangle(h5::compound(sizeof(Triangle), {{"v", 0, corners.id()}})),
      box(h5::compound(sizeof(Box), {{"lo", 0, vec3.id()}, {"hi", 12, vec3.id()}})),
      geometry(
          h5::compound(sizeof(GeometryRow), {{"first", offsetof(GeometryRow, first), u32()},
                                             {"count", offsetof(GeometryRow, count), u32()},
                                             {"opaque", offsetof(GeometryRow, opaque), u32()}})),
      blas(h5::compound(sizeof(BlasRow),
                        {{"first_triangle", offsetof(BlasRow, first_triangle), u64()},
                         {"first_aabb", offsetof(BlasRow, first_aabb), u64()},
                         {"first_geometry", offsetof(BlasRow, first_geometry), u64()},
                         {"first_node_byte", offsetof(BlasRow, first_node_byte), u64()},
                         {"node_bytes", offsetof(BlasRow, node_bytes), u64()},
                         {"triangles", offsetof(BlasRow, triangles), u32()},
                         {"aabbs", offsetof(BlasRow, aabbs), u32()},
                         {"geometries", offsetof(BlasRow, geometries), u32()}})),
      instance(h5::compound(sizeof(Instance),
                            {{"object_to_world", offsetof(Instance, object_to_world), map.id()},
                             {"world_to_object", offsetof(Instance, world_to_object), map.id()},
                             {"blas", offsetof(Instance, blas), u32()},
                             {"custom_index", offsetof(Instance, custom_index), u32()},
                             {"mask", offsetof(Instance, mask), u32()},
                             {"sbt_offset", offsetof(Instance, sbt_offset), u32()},
                             {"flags", offsetof(Instance, flags), u32()}})),
      tlas(h5::compound(sizeof(TlasRow),
                        {{"first_instance", offsetof(TlasRow, first_instance), u64()},
                         {"first_node_byte", offsetof(TlasRow, first_node_byte), u64()},
                         {"node_bytes", offsetof(TlasRow, node_bytes), u64()},
                         {"instances", offsetof(TlasRow, instances), u32()}})),
      dispatch(h5::compound(sizeof(Dispatch),
                            {{"frame", offsetof(Dispatch, frame), u32()},
                             {"width", offsetof(Dispatch, width), u32()},
                             {"height", offsetof(Dispatch, height), u32()},
                             {"depth", offsetof(Dispatch, depth), u32()},
                             {"first_ray", offsetof(Dispatch, first_ray), u64()},
                             {"ray_count", offsetof(Dispatch, ray_count), u64()},
                             {"first_segment", offsetof(Dispatch, first_segment), u64()},
                             {"segment_count", offsetof(Dispatch, segment_count), u64()}})),
      shader(h5::compound(sizeof(ShaderRow), {{"hash", offsetof(ShaderRow, hash), u64()},
                                              {"stage", offsetof(ShaderRow, stage), u32()},
                                              {"entry", offsetof(ShaderRow, entry), entry.id()}})),
      ray(h5::compound(sizeof(Ray), {{"origin", offsetof(Ray, origin), vec3.id()},
                                     {"tmin", offsetof(Ray, tmin), f32()},
                                     {"dir", offsetof(Ray, dir), vec3.id()},
                                     {"tmax", offsetof(Ray, tmax), f32()},
                                     {"flags", offsetof(Ray, flags), u32()},
                                     {"mask", offsetof(Ray, mask), u32()},
                                     {"tlas", offsetof(Ray, tlas), u32()},
                                     {"sbt", offsetof(Ray, sbt), u32()},
                                     {"dispatch", offsetof(Ray, dispatch), u32()},
                                     {"launch", offsetof(Ray, launch), u32()},
                                     {"ordinal", offsetof(Ray, ordinal), u32()},
                                     {"parent", offsetof(Ray, parent), u32()}})),
      hit(h5::compound(sizeof(Hit), {{"state", offsetof(Hit, state), u32()},
                                     {"t", offsetof(Hit, t), f32()},
                                     {"instance", offsetof(Hit, instance), u32()},
                                     {"geometry", offsetof(Hit, geometry), u32()},
                                     {"primitive", offsetof(Hit, primitive), u32()},
                                     {"kind", offsetof(Hit, kind), u32()}})),
      candidate(
          h5::compound(sizeof(Candidate), {{"instance", offsetof(Candidate, instance), u32()},
                                           {"geometry", offsetof(Candidate, geometry), u32()},
                                           {"primitive", offsetof(Candidate, primitive), u32()},
                                           {"t", offsetof(Candidate, t), f32()},
                                           {"kind", offsetof(Candidate, kind), u32()},
                                           {"verdict", offsetof(Candidate, verdict), u32()},
                                           {"is_report", offsetof(Candidate, is_report), u32()}})),
      segment(h5::compound(sizeof(Segment), {{"launch", offsetof(Segment, launch), u32()},
                                             {"shader", offsetof(Segment, shader), u32()},
                                             {"counts", offsetof(Segment, counts), counts.id()},
                                             {"ray", offsetof(Segment, ray), u32()}})) {}

std::uint64_t hash_bytes(const std::byte* data, std::size_t bytes) {
  constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15u;
  std::uint64_t lanes[4] = {kOdd, kOdd * 3, kOdd * 5, kOdd * 7};
  const auto mix = [](std::uint64_t lane, std::uint64_t word) {
    return std::rotl(lane ^ word, 29) * kOdd;
  };
  std::size_t at = 0;
  for (; at + 32 <= bytes; at += 32) {
    std::uint64_t words[4];
    std::memcpy(words, data + at, 32);
    for (int i = 0; i < 4; ++i) {
      lanes[i] = mix(lanes[i], words[i]);
    }
  }
  std::uint64_t hash = bytes;
  for (const std::uint64_t lane : lanes) {
    hash = mix(hash, lane);
  }
  for (; at < bytes; ++at) {
    hash = mix(hash, std::to_integer<std::uint64_t>(data[at]));
  }
  return hash ^ (hash >> 31);
}

}  // namespace a2rt::file
