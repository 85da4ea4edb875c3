#include "a2rt/bvh/layout_aqb8.h"

#include "a2rt/bvh/packing.h"

namespace a2rt::bvh {
namespace {

void write_box(ByteWriter& out, const arith::Aqb8Box& box) {
  for (std::size_t a = 0; a < 3; ++a) {
    out.u8(box.lo[a]);
    out.u8(box.hi[a]);
  }
}

void write_anchor(ByteWriter& out, const arith::Aqb8Anchor& anchor, const Cluster& cluster) {
  for (std::size_t a = 0; a < 3; ++a) {
    out.f32(anchor.box.lo[a]);
    out.f32(anchor.box.hi[a]);
  }
  out.f32(anchor.inv_sx_inv_sw);
  out.u32(cluster.node_offset);
  out.u32(cluster.triangle_offset);
}

// The artifact's child word of record i, which lives in `home`.
std::uint32_t child_word(const WideBvh& bvh, const Clustering& clusters, const Cluster& home,
                         std::uint32_t i) {
  constexpr std::uint32_t kInCluster = 0x8000;
  const BvhRecord& r = bvh.records[i];
  if (r.leaf()) {
    return kInCluster | std::uint32_t{r.count} << 12 |
           (clusters.first_primitive[i] - home.triangle_offset);
  }
  if (clusters.is_switch[i] != 0) {
    return clusters.cluster[i];
  }
  return kInCluster | (clusters.position[r.first] - home.node_offset);
}

void write_wide_word(ByteWriter& out, const WideBvh& bvh, const Clustering& clusters,
                     std::uint32_t i) {
  const BvhRecord& r = bvh.records[i];
  const bool opens = clusters.is_switch[i] != 0;
  out.u8(static_cast<std::uint32_t>(r.leaf() ? Aqb8Kind::kLeaf
                                    : opens  ? Aqb8Kind::kSwitch
                                             : Aqb8Kind::kInner));
  out.u8(r.count);
  out.u32(r.leaf() ? clusters.first_primitive[i]
          : opens  ? clusters.cluster[i]
                   : clusters.position[r.first]);
  out.u32(r.leaf() ? 0 : clusters.position[r.first]);
}

}  // namespace

Aqb8Layout encode_aqb8(const WideBvh& bvh, const Clustering& clusters, std::uint32_t record_bytes,
                       const std::string& what, const arith::Aqb8Precision& precision) {
  if (record_bytes != 8 && record_bytes != 16) {
    throw UserError("AQB8 nodes are 8 or 16 bytes, not " + std::to_string(record_bytes));
  }
  check_boxes(bvh, what);
  Aqb8Layout layout;
  ByteWriter anchors(layout.anchor_bytes, clusters.clusters.size() * kAqb8AnchorBytes);
  ByteWriter nodes(layout.node_bytes, clusters.order.size() * record_bytes);
  layout.boxes.reserve(clusters.order.size());
  for (const Cluster& c : clusters.clusters) {
    layout.anchors.push_back(arith::make_aqb8_anchor(
        bvh.records[c.anchor].box, what + ", anchor node " + std::to_string(c.anchor), precision));
    write_anchor(anchors, layout.anchors.back(), c);
    for (std::uint32_t p = c.node_offset; p < c.node_offset + c.node_count; ++p) {
      const std::uint32_t i = clusters.order[p];
      const BvhRecord& r = bvh.records[i];
      if (r.leaf() && r.count > kAqb8MostLeaf) {
        throw UserError(what + ", node " + std::to_string(i) + ": AQB8 leaves hold at most 7 " +
                        "primitives; set tree.max_leaf to 7 or less");
      }
      layout.boxes.push_back(arith::quantize_aqb8(r.box, layout.anchors.back(), what));
      write_box(nodes, layout.boxes.back());
      if (record_bytes == 8) {
        nodes.u16(child_word(bvh, clusters, c, i));
      } else {
        write_wide_word(nodes, bvh, clusters, i);
      }
    }
  }
  anchors.finish();
  nodes.finish();
  return layout;
}

Aqb8Record decode_aqb8(std::span<const std::byte> node_bytes, std::uint32_t record_bytes,
                       std::uint32_t position) {
  ByteReader in(node_bytes, std::size_t{position} * record_bytes);
  Aqb8Record r;
  for (std::size_t a = 0; a < 3; ++a) {
    r.box.lo[a] = static_cast<std::uint8_t>(in.u8());
    r.box.hi[a] = static_cast<std::uint8_t>(in.u8());
  }
  if (record_bytes == 16) {
    r.kind = static_cast<Aqb8Kind>(in.u8());
    r.count = in.u8();
    r.first = in.u32();
    return r;
  }
  const std::uint32_t word = in.u16();
  if ((word & 0x8000U) == 0) {
    r.kind = Aqb8Kind::kSwitch;
    r.first = word;
    return r;
  }
  r.count = (word >> 12) & 7U;
  r.kind = r.count == 0 ? Aqb8Kind::kInner : Aqb8Kind::kLeaf;
  r.first = word & 0xfffU;
  return r;
}

}  // namespace a2rt::bvh
