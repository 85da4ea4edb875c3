#include "capture/structure_writer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <string>

#include "capture/geometry_reader.h"
#include "layer/log.h"
#include "rebuild/driver_tree.h"

namespace a2rt::layer {
namespace {

std::string name_of(const StructureBuild& build, VkDeviceAddress address) {
  const bool top = build.type == VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR;
  char text[48];
  std::snprintf(text, sizeof(text), "%s at 0x%llx", top ? "TLAS" : "BLAS",
                static_cast<unsigned long long>(address));
  return text;
}

bool same_value(float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool is_opaque(const VkAccelerationStructureGeometryKHR& geometry) {
  return (geometry.flags & VK_GEOMETRY_OPAQUE_BIT_KHR) != 0;
}

// Primitives of a BLAS that differ from the driver's leaves; nothing if a format is unknown.
std::optional<std::uint64_t> differing_triangles(const StructureBuild& build,
                                                 std::span<const DriverTriangle> leaves,
                                                 FirstVertex first_vertex) {
  std::uint64_t differing = 0;
  std::size_t leaf = 0;
  for (std::size_t g = 0; g < build.geometries.size(); ++g) {
    const TriangleReader reader(build.geometries[g].geometry.triangles, build.ranges[g],
                                first_vertex);
    if (!reader.supported()) {
      return std::nullopt;
    }
    for (std::uint32_t p = 0; p < build.ranges[g].primitiveCount; ++p, ++leaf) {
      const auto mine = reader.read(p);
      const DriverTriangle& its = leaves[leaf];
      const bool same = its.primitive == p && (its.geometry_and_flags & 0x0fffffffu) == g &&
                        std::equal(mine.begin(), mine.end(), its.vertices, same_value);
      differing += same ? 0 : 1;
    }
  }
  return differing;
}

std::uint64_t differing_aabbs(const StructureBuild& build, std::span<const DriverAabb> leaves) {
  std::uint64_t differing = 0;
  std::size_t leaf = 0;
  for (std::size_t g = 0; g < build.geometries.size(); ++g) {
    for (std::uint32_t p = 0; p < build.ranges[g].primitiveCount; ++p, ++leaf) {
      const auto mine = read_aabb(build.geometries[g].geometry.aabbs, build.ranges[g], p);
      const DriverAabb& its = leaves[leaf];
      const bool same = its.primitive == p && (its.geometry_and_flags & 0x0fffffffu) == g &&
                        std::memcmp(mine.data(), &its.bounds, sizeof(its.bounds)) == 0;
      differing += same ? 0 : 1;
    }
  }
  return differing;
}

bool has_first_vertex(const StructureBuild& build) {
  return std::any_of(build.ranges.begin(), build.ranges.end(),
                     [](const auto& range) { return range.firstVertex != 0; });
}

// Whether the driver's leaves are the program's primitives.
bool leaves_agree(const StructureBuild& build, const DriverTree& tree, LeafKind kind,
                  std::string& why) {
  const std::uint64_t count = build.primitives();
  if (kind == LeafKind::kAabb) {
    const std::uint64_t differing = differing_aabbs(build, tree.aabbs());
    why = std::to_string(differing) + " of " + std::to_string(count) + " boxes differ";
    return differing == 0;
  }
  auto differing = differing_triangles(build, tree.triangles(), FirstVertex::kOnce);
  if (differing.value_or(0) != 0 && has_first_vertex(build)) {
    const auto twice = differing_triangles(build, tree.triangles(), FirstVertex::kTwice);
    if (twice == std::uint64_t{0}) {
      info("the driver applies firstVertex twice; the capture has the triangles it traces");
      return true;
    }
  }
  if (!differing) {
    why = "a vertex or index format is unknown";
    return false;
  }
  why = std::to_string(*differing) + " of " + std::to_string(count) + " triangles differ";
  return *differing == 0;
}

std::vector<float> primitives_from_inputs(const StructureBuild& build, LeafKind kind) {
  std::vector<float> out;
  out.reserve(build.primitives() * 9);
  for (std::size_t g = 0; g < build.geometries.size(); ++g) {
    const auto& geometry = build.geometries[g].geometry;
    for (std::uint32_t p = 0; p < build.ranges[g].primitiveCount; ++p) {
      if (kind == LeafKind::kAabb) {
        const auto box = read_aabb(geometry.aabbs, build.ranges[g], p);
        out.insert(out.end(), box.begin(), box.end());
      } else {
        const TriangleReader reader(geometry.triangles, build.ranges[g], FirstVertex::kOnce);
        const auto triangle = reader.read(p);
        out.insert(out.end(), triangle.begin(), triangle.end());
      }
    }
  }
  return out;
}

std::vector<float> primitives_from_leaves(const DriverTree& tree, LeafKind kind) {
  std::vector<float> out;
  if (kind == LeafKind::kAabb) {
    out.reserve(std::size_t{tree.leaves()} * 6);
    for (const DriverAabb& leaf : tree.aabbs()) {
      out.insert(out.end(), leaf.bounds.lo, leaf.bounds.lo + 3);
      out.insert(out.end(), leaf.bounds.hi, leaf.bounds.hi + 3);
    }
    return out;
  }
  out.reserve(std::size_t{tree.leaves()} * 9);
  for (const DriverTriangle& leaf : tree.triangles()) {
    out.insert(out.end(), leaf.vertices, leaf.vertices + 9);
  }
  return out;
}

// The affine inverse, for structures whose layout the layer does not know.
void invert(const float (&m)[3][4], float (&out)[3][4]) {
  double a[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      a[j][i] = double{m[i1][j1]} * m[i2][j2] - double{m[i1][j2]} * m[i2][j1];
    }
  }
  const double det = m[0][0] * a[0][0] + m[0][1] * a[1][0] + m[0][2] * a[2][0];
  for (int i = 0; i < 3; ++i) {
    double translation = 0;
    for (int j = 0; j < 3; ++j) {
      out[i][j] = static_cast<float>(a[i][j] / det);
      translation -= a[i][j] / det * m[j][3];
    }
    out[i][3] = static_cast<float>(translation);
  }
}

capture::InstanceBlock instance_block(const VkAccelerationStructureInstanceKHR& instance) {
  capture::InstanceBlock block{};
  std::memcpy(block.object_to_world, &instance.transform, sizeof(block.object_to_world));
  block.custom_index = instance.instanceCustomIndex;
  block.mask = instance.mask;
  block.sbt_offset = instance.instanceShaderBindingTableRecordOffset;
  block.flags = instance.flags;
  block.blas_address = instance.accelerationStructureReference;
  return block;
}

std::vector<capture::InstanceBlock> read_instances(const StructureBuild& build) {
  std::vector<capture::InstanceBlock> blocks;
  for (std::size_t g = 0; g < build.geometries.size(); ++g) {
    for (std::uint32_t i = 0; i < build.ranges[g].primitiveCount; ++i) {
      blocks.push_back(instance_block(
          read_instance(build.geometries[g].geometry.instances, build.ranges[g], i)));
    }
  }
  return blocks;
}

// Checks the driver's leaves against the instances and takes the driver's inverse transforms.
bool take_inverses(const DriverTree& tree, std::vector<capture::InstanceBlock>& blocks,
                   std::string& why) {
  for (const DriverInstance& leaf : tree.instances()) {
    if (leaf.instance >= blocks.size()) {
      why = "a leaf has an instance number out of range";
      return false;
    }
    capture::InstanceBlock& block = blocks[leaf.instance];
    const bool same = leaf.structure == block.blas_address &&
                      leaf.custom_index_and_mask == (block.custom_index | block.mask << 24) &&
                      std::memcmp(leaf.object_to_world, block.object_to_world,
                                  sizeof(block.object_to_world)) == 0;
    if (!same) {
      why = "instance " + std::to_string(leaf.instance) + " differs";
      return false;
    }
    std::memcpy(block.world_to_object, leaf.world_to_object, sizeof(block.world_to_object));
  }
  return true;
}

capture::AsBlock as_block(const StructureBuild& build, std::uint64_t id, VkDeviceAddress address) {
  capture::AsBlock block{};
  block.id = id;
  block.address = address;
  block.geometry_count = static_cast<std::uint32_t>(build.geometries.size());
  block.count = static_cast<std::uint32_t>(build.primitives());
  block.build_flags = build.flags;
  block.is_update = build.is_update ? 1 : 0;
  return block;
}

// Rebuilds and logs; the tree's depth afterwards.
std::uint32_t rebuild(DriverTree& tree, const std::string& name, std::uint32_t limit,
                      const StructureOptions& options) {
  if (!options.rebuild) {
    return tree.depth();
  }
  std::string why;
  const auto start = std::chrono::steady_clock::now();
  if (!tree.rebuild(limit, options.threads, why)) {
    (tree.leaves() > 2 ? info : debug)(name + " keeps the driver's tree: " + why);
    return tree.depth();
  }
  const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
  const std::uint32_t depth = tree.depth();
  debug(name + ": rebuilt over " + std::to_string(tree.leaves()) + " leaves, depth " +
        std::to_string(depth) + ", " + std::to_string(time.count()) + " ms");
  return depth;
}

}  // namespace

std::uint64_t StructureBuild::primitives() const {
  std::uint64_t count = 0;
  for (const auto& range : ranges) {
    count += range.primitiveCount;
  }
  return count;
}

void StructureWriter::refuse(const std::string& what) {
  if (manifest_ != nullptr) {
    manifest_->refuse(what);
  } else {
    warn(what);
  }
}

void StructureWriter::built(const StructureBuild& build) {
  const VkDeviceAddress address = structures_.address(build.target);
  if (address == 0) {
    refuse("a structure was built that the layer did not see created; it is not captured");
    return;
  }
  if (build.type == VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR) {
    top_level(build, address);
  } else {
    bottom_level(build, address);
  }
}

void StructureWriter::bottom_level(const StructureBuild& build, VkDeviceAddress address) {
  const std::string name = name_of(build, address);
  const bool boxes =
      !build.geometries.empty() && build.geometries[0].geometryType == VK_GEOMETRY_TYPE_AABBS_KHR;
  const LeafKind kind = boxes ? LeafKind::kAabb : LeafKind::kTriangle;
  const auto count = static_cast<std::uint32_t>(build.primitives());
  auto* const memory = reinterpret_cast<void*>(address);

  std::optional<DriverTree> tree;
  std::string why;
  if (count != 0) {
    if (DriverTree::matches(memory, kind, count, why)) {
      tree.emplace(memory, kind, count);
      if (!leaves_agree(build, *tree, kind, why)) {
        tree.reset();
      }
    }
    if (!tree) {
      warn(name + ": the driver's layout is not the one this layer knows (" + why +
           "); its tree is left alone and its nodes are not captured");
    }
  }
  BuiltStructure state;
  state.id = structures_.new_id();
  state.depth = tree ? rebuild(*tree, name, kBlasDepthLimit, options_) : 0;
  state.has_non_opaque = !std::all_of(build.geometries.begin(), build.geometries.end(), is_opaque);
  structures_.built(address, state);
  if (manifest_ == nullptr) {
    return;
  }
  capture::AsBlock block = as_block(build, state.id, address);
  std::vector<capture::GeometryBlock> geometries;
  for (std::size_t g = 0; g < build.geometries.size(); ++g) {
    geometries.push_back(
        {boxes ? 1u : 0u, build.geometries[g].flags, build.ranges[g].primitiveCount, 0});
  }
  const std::vector<float> primitives =
      tree ? primitives_from_leaves(*tree, kind) : primitives_from_inputs(build, kind);
  const Bytes nodes = tree ? tree->memory() : Bytes{};
  block.node_bytes = nodes.size();
  manifest_->write(capture::BlockType::kBlas,
                   {bytes_of(block), bytes_of(geometries), bytes_of(primitives), nodes});
}

void StructureWriter::top_level(const StructureBuild& build, VkDeviceAddress address) {
  const std::string name = name_of(build, address);
  std::vector<capture::InstanceBlock> instances = read_instances(build);
  const auto count = static_cast<std::uint32_t>(instances.size());
  auto* const memory = reinterpret_cast<void*>(address);

  std::optional<DriverTree> tree;
  std::string why;
  if (count != 0) {
    if (DriverTree::matches(memory, LeafKind::kInstance, count, why)) {
      tree.emplace(memory, LeafKind::kInstance, count);
      if (!take_inverses(*tree, instances, why)) {
        tree.reset();
      }
    }
    if (!tree) {
      warn(name + ": the driver's layout is not the one this layer knows (" + why +
           "); its tree is left alone and its nodes are not captured");
      for (capture::InstanceBlock& instance : instances) {
        invert(instance.object_to_world, instance.world_to_object);
      }
    }
  }
  BuiltStructure state;
  state.id = structures_.new_id();
  if (tree) {
    std::uint32_t deepest = 0;
    for (const capture::InstanceBlock& instance : instances) {
      const auto blas = structures_.at(instance.blas_address);
      deepest = std::max(deepest, blas ? blas->depth : 0);
    }
    const std::uint32_t limit = deepest < kStackEntries ? kStackEntries - deepest : 0;
    state.depth = rebuild(*tree, name, limit, options_);
  }
  structures_.built(address, state);
  if (manifest_ == nullptr) {
    return;
  }
  capture::AsBlock block = as_block(build, state.id, address);
  block.geometry_count = 1;
  const Bytes nodes = tree ? tree->memory() : Bytes{};
  block.node_bytes = nodes.size();
  manifest_->write(capture::BlockType::kTlas, {bytes_of(block), bytes_of(instances), nodes});
}

void StructureWriter::copied(VkAccelerationStructureKHR source,
                             VkAccelerationStructureKHR destination) {
  const VkDeviceAddress from = structures_.address(source);
  const VkDeviceAddress to = structures_.address(destination);
  auto state = structures_.at(from);
  if (!state) {
    refuse("a structure was copied that the layer did not see built; the copy is not captured");
    return;
  }
  state->id = structures_.new_id();
  structures_.built(to, *state);
  if (manifest_ != nullptr) {
    const capture::AsCopyBlock block{from, to, state->id};
    manifest_->write(capture::BlockType::kAsCopy, {bytes_of(block)});
  }
}

}  // namespace a2rt::layer
