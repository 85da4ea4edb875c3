// AQB8: multi-level 8-bit boxes with one scale per cluster and integer ray-box tests (Huang, Yang,
// Yeh, ISCA 2025, after its public artifact).
#include <cmath>
#include <cstdlib>

#include "a2rt/config/section.h"
#include "a2rt/rt/aqb8_unit.h"
#include "a2rt/rt/tree_unit.h"

namespace a2rt::rt {
namespace {

const RegisterUnit kRegistered("aqb8", [](const config::Section& section) {
  return std::make_unique<TreeUnit<Aqb8Unit>>(Aqb8Unit(section));
});

constexpr int kReciprocalBias = 127;

}  // namespace

Aqb8Unit::Space::Space(const Aqb8Unit& unit, const Vec3& origin, const Vec3& dir, float tmin,
                       const Tree&) {
  Vec3 d = dir;
  if (unit.normalize_) {
    const float norm = std::sqrt(dir.x * dir.x + dir.y * dir.y + dir.z * dir.z);
    if (norm > 0 && std::isfinite(norm)) {
      length = norm;
      d = {dir.x / norm, dir.y / norm, dir.z / norm};
    }
  }
  ray = arith::make_aqb8_ray(origin, d, scaled(tmin), unit.precision());
}

Aqb8Unit::Aqb8Unit(const config::Section& section)
    : info_{"aqb8", "AQB8", "Huang, Yang, Yeh, ISCA 2025 (public artifact)", Promise::kMayMiss,
            BoxTesters::kAqb8},
      settings_(read_unit_settings(section, bvh::kAqb8MostLeaf, bvh::kAqb8MostLeaf)) {
  artifact_ = section.boolean("artifact", false,
                              "Reproduce the public 6-wide code: sliding window, aliased node "
                              "addresses, its line accounting and its order of visits");
  normalize_ = section.boolean("normalize", true, "Divide the direction by its length first");
  rounding_ =
      section.choice("rounding", "floor", {"floor", "nearest"},
                     "FP32 to integer at a cluster's entry: software model or RTL") == "floor"
          ? arith::Aqb8Rounding::kFloorCeil
          : arith::Aqb8Rounding::kNearestEven;
  const config::Section p = section.table("precision");
  clusters_.precision.box_bits = static_cast<int>(
      p.integer("box_bits", 8, 4, 8, "bits", "Used of the eight that a stored plane has"));
  clusters_.precision.slope_bits =
      static_cast<int>(p.integer("slope_bits", 8, 2, 8, "bits", "Significand of the 5e8m slopes"));
  const config::Section c = section.table("clusters");
  clusters_.t_trv_int = c.number("t_trv_int", 0.5, 0, 1e6, "cost", "Quantized box test");
  clusters_.t_switch = c.number("t_switch", artifact_ ? 0.8 : 1.0, 0, 1e6, "cost",
                                "Anchor test (6-wide artifact 0.8, 2-wide 1)");
  clusters_.t_ist = c.number("t_ist", 1, 0, 1e6, "cost", "Triangle test");
  clusters_.leaf_count = c.boolean("leaf_count", !artifact_,
                                   "Leaf cost counts triangles; the 6-wide artifact drops it");
  const config::Section layout = section.table("layout");
  node_bytes_ = static_cast<std::uint32_t>(layout.integer(
      "node_bytes", 16, 8, 16, "bytes", "Node record: 16 (A2RT paper) or 8 (artifact, limited)"));
  if (node_bytes_ != 8 && node_bytes_ != 16) {
    throw UserError("layout.node_bytes of aqb8 is 8 or 16, not " + std::to_string(node_bytes_));
  }
  if (node_bytes_ == 8 || artifact_) {
    clusters_.capacity = bvh::kAqb8WordCapacity;
    clusters_.most_clusters = bvh::kAqb8WordClusters;
  }
  if (artifact_) {
    anchor_bytes_ = kArtifactAnchorBytes;
    node_bytes_ = kArtifactNodeBytes;
    adopt_accounting(section, settings_, Accounting::kPublished);
    if (settings_.layout.accounting == Accounting::kRecords) {
      throw UserError(
          "aqb8 with artifact = true has overlapping node records, which are charged in "
          "lines; set layout.accounting to published or corrected");
    }
  }
}

Aqb8Tree Aqb8Unit::encode(bvh::WideBvh& tree, const std::string& name, bvh::AddressSpace& space,
                          StructureStats& stats) const {
  bvh::Clustering clusters;
  stats.classify_seconds += seconds_of([&] { clusters = bvh::cluster_aqb8(tree, clusters_); });
  Aqb8Tree result;
  stats.encode_seconds += seconds_of([&] {
    // Cluster order is the artifact's order of triangles; from here on it is the tree's own.
    bvh::adopt_cluster_order(tree, clusters);
    bvh::Aqb8Layout layout =
        bvh::encode_aqb8(tree, clusters, artifact_ ? 8 : node_bytes_, name, precision());
    const std::uint64_t nodes = std::uint64_t{clusters.order.size()} * node_bytes_;
    const std::uint64_t anchors = std::uint64_t{clusters.clusters.size()} * anchor_bytes_;
    stats.group_nodes += clusters.clusters.size();
    stats.sub_nodes += clusters.order.size();
    stats.group_bytes += anchors;
    stats.sub_bytes += nodes;
    stats.node_bytes += anchors + nodes;
    const Address anchor_base = space.reserve(name + " anchors", Bytes{anchors});
    const Address node_base = space.reserve(name + " nodes", Bytes{nodes});
    result = Aqb8Tree::mirror(tree, clusters, std::move(layout));
    result.set_bases(anchor_base, node_base);
  });
  return result;
}

// In the order of the artifact's own failure modes: the first that applies names the miss.
std::string Aqb8Unit::miss_mechanism(const Space& space, const Context& context) const {
  for (std::size_t a = 0; a < 3; ++a) {
    const float w = std::fabs(space.ray.w[a]);
    if (std::isinf(w)) {
      return "zero direction component: slope taken as 1";
    }
    if (w < 1) {
      return "direction longer than 1: exponent wraps";
    }
    const int exponent = std::ilogb(w);
    static_assert(kReciprocalBias == 127);
    if (exponent >= 32) {
      return "5-bit exponent wraps (|d| <= 2^-32)";
    }
    if (exponent >= 16) {
      return "5-bit shift overflows 32 bits (|d| < 2^-16)";
    }
    if (context.local.low[a] == INT32_MAX || context.local.low[a] == INT32_MIN) {
      return "local origin saturates";
    }
  }
  return rounding_ == arith::Aqb8Rounding::kNearestEven ? "FP32 cancellation or rounding to nearest"
                                                        : "FP32 cancellation";
}

}  // namespace a2rt::rt
