#include "import_manifest.h"

#include "a2rt/capture/records.h"
#include "byte_reader.h"
#include "import_scene.h"

namespace a2rt::import {
namespace {

using namespace capture;

constexpr std::uint32_t kGeometryOpaqueBit = 1;   // VK_GEOMETRY_OPAQUE_BIT_KHR
constexpr std::uint32_t kMostShaders = 1u << 20;  // more is damage
constexpr std::uint32_t kTriangleGeometry = 0, kAabbGeometry = 1;

class ManifestParser {
 public:
  ManifestParser(std::span<const std::byte> bytes, Workload& workload)
      : in_(bytes, "manifest.bin"), workload_(workload), scene_(workload) {}

  Manifest run() {
    if (in_.get<std::uint32_t>("the file's magic number") != kManifestMagic) {
      throw UserError("manifest.bin: not a manifest of a capture (wrong magic number)");
    }
    const auto version = in_.get<std::uint32_t>("the format version");
    if (version != kFormatVersion) {
      throw UserError("manifest.bin: capture format version " + std::to_string(version) +
                      ", this program reads version " + std::to_string(kFormatVersion) +
                      "; use layer and program of the same build");
    }
    while (!ended_) {
      if (in_.left() == 0) {
        in_.fail(
            "ends without its closing block: the program was killed or the disk was full; "
            "capture again");
      }
      const auto header = in_.get<BlockHeader>("a block header");
      ByteReader payload = in_.sub(header.bytes, "a block's payload");
      block(static_cast<BlockType>(header.type), payload);
    }
    return std::move(manifest_);
  }

 private:
  void block(BlockType type, ByteReader& in) {
    switch (type) {
      case BlockType::kDriver:
        return driver(in);
      case BlockType::kShader:
        return shader(in);
      case BlockType::kBlas:
        return blas(in);
      case BlockType::kTlas:
        return tlas(in);
      case BlockType::kAsCopy:
        return copy(in);
      case BlockType::kAsDestroyed:
        return scene_.destroy(in.get<AsDestroyedBlock>("a destruction").address);
      case BlockType::kDispatch:
        return dispatch(in);
      case BlockType::kRefused:
        manifest_.refused.push_back(in.get_text("a refusal"));
        return;
      case BlockType::kEffects:
        return effects(in);
      case BlockType::kEnd:
        manifest_.end = in.get<EndBlock>("the closing block");
        ended_ = true;
        return;
      default:
        return;  // pipelines and later inventions are not needed here
    }
  }

  void driver(ByteReader& in) {
    const auto block = in.get<DriverBlock>("a driver block");
    const std::string device = in.get_text("the device name");
    const std::string name = in.get_text("the driver name");
    const std::string info = in.get_text("the driver info");
    Provenance& p = workload_.provenance;
    p.driver = name + " " + info + ", " + device;
    p.command_line = in.get_text("the command line");
    p.program = p.command_line.substr(0, p.command_line.find(' '));
    p.program = p.program.substr(p.program.find_last_of('/') + 1);
    p.tree_rebuilt = block.tree_rebuilt != 0;
  }

  void shader(ByteReader& in) {
    const auto block = in.get<ShaderBlock>("a shader block");
    if (block.shader >= kMostShaders) {
      in.fail("shader index " + std::to_string(block.shader) + " is not believable");
    }
    if (workload_.shaders.size() <= block.shader) {
      workload_.shaders.resize(block.shader + 1);
    }
    workload_.shaders[block.shader] = {block.stage, block.hash,
                                       in.get_text("an entry point's name")};
  }

  void effects(ByteReader& in) {
    const auto block = in.get<EffectsBlock>("an effects block");
    for (std::uint32_t i = 0; i < block.site_count; ++i) {
      const auto site = in.get<SiteBlock>("a trace site");
      if (site.is_query != 0) {
        manifest_.query_sites.emplace(block.shader, site.site);
      }
    }
  }

  void blas(ByteReader& in) {
    const auto block = in.get<AsBlock>("an acceleration structure block");
    std::vector<GeometryBlock> geometries;
    in.get_rows(geometries, block.geometry_count, "geometries");
    Blas blas;
    std::uint64_t count = 0;
    for (const GeometryBlock& g : geometries) {
      if (g.type != geometries.front().type || g.type > kAabbGeometry) {
        in.fail("geometry types " + std::to_string(geometries.front().type) + " and " +
                std::to_string(g.type) + " in one structure");
      }
      blas.geometries.push_back(
          {static_cast<std::uint32_t>(count), g.count, (g.flags & kGeometryOpaqueBit) != 0});
      count += g.count;
    }
    if (count != block.count) {
      in.fail("the geometries have " + std::to_string(count) + " primitives, the structure " +
              std::to_string(block.count));
    }
    if (geometries.empty() || geometries.front().type == kTriangleGeometry) {
      in.get_rows(blas.triangles, count, "triangles");
    } else {
      in.get_rows(blas.aabbs, count, "boxes");
    }
    in.get_rows(blas.driver_nodes, block.node_bytes, "bytes of driver nodes");
    scene_.add_blas(block, std::move(blas));
  }

  void tlas(ByteReader& in) {
    const auto block = in.get<AsBlock>("an acceleration structure block");
    std::vector<InstanceBlock> instances;
    in.get_rows(instances, block.count, "instances");
    RawTlas tlas;
    for (const InstanceBlock& source : instances) {
      RawInstance raw;
      std::memcpy(&raw.instance.object_to_world, source.object_to_world, sizeof(Affine));
      std::memcpy(&raw.instance.world_to_object, source.world_to_object, sizeof(Affine));
      raw.instance.custom_index = source.custom_index;
      raw.instance.mask = source.mask;
      raw.instance.sbt_offset = source.sbt_offset;
      raw.instance.flags = source.flags;
      raw.blas_address = source.blas_address;
      tlas.instances.push_back(raw);
    }
    in.get_rows(tlas.driver_nodes, block.node_bytes, "bytes of driver nodes");
    scene_.add_tlas(block, std::move(tlas));
  }

  void copy(ByteReader& in) {
    const auto block = in.get<AsCopyBlock>("a copy block");
    if (!scene_.copy(block)) {
      in.fail("copies an acceleration structure that was never built");
    }
  }

  void dispatch(ByteReader& in) {
    RawDispatch raw;
    raw.block = in.get<DispatchBlock>("a dispatch block");
    if (raw.block.dispatch != manifest_.dispatches.size()) {
      in.fail("dispatch " + std::to_string(raw.block.dispatch) + " follows " +
              std::to_string(manifest_.dispatches.size()) + " others");
    }
    for (std::uint32_t i = 0; i < raw.block.site_count; ++i) {
      const auto site = in.get<SiteBinding>("a site binding");
      raw.tlas[{site.shader, site.site}] = scene_.resolve(site.tlas_id);
    }
    raw.only_tlas = scene_.resolve(0);
    manifest_.dispatches.push_back(std::move(raw));
  }

  ByteReader in_;
  Workload& workload_;
  SceneTimeline scene_;
  Manifest manifest_;
  bool ended_ = false;
};

}  // namespace

Manifest read_manifest(std::span<const std::byte> bytes, Workload& workload) {
  return ManifestParser(bytes, workload).run();
}

}  // namespace a2rt::import
