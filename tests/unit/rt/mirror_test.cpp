// What is traversed is what is stored: the in-memory mirrors against the packed bytes, record by
// record, walking both from the root.
#include <gtest/gtest.h>

#include <functional>

#include "a2rt/bvh/layout_fp32.h"
#include "a2rt/bvh/layout_pow2.h"
#include "a2rt/bvh/packing.h"
#include "a2rt/rt/a2rt_unit.h"
#include "a2rt/rt/aqb8_unit.h"
#include "a2rt/rt/box_tree.h"
#include "a2rt/rt/tree_unit.h"
#include "runs.h"

namespace a2rt::rt {
namespace {

using bvh::ChildRef;
using synthetic::Shape;

bvh::WideBvh wide(const Workload& w, const bvh::WideBuildConfig& config = {}) {
  return bvh::WideBuilder(config).build(std::span<const Triangle>(w.blas.at(0).triangles));
}

// The A2RT record at `offset` against the reference and, for sub nodes and groups, the box that the
// parent's mirror holds in `slot`. Returns the record's size.
class A2rtWalk {
 public:
  A2rtWalk(const A2rtTree& tree, const arith::A2rtPrecision& precision)
      : tree_(tree), precision_(precision), tester_(precision) {}

  std::size_t run() {
    const A2rtNode& root = tree_.node(tree_.root().index());
    EXPECT_EQ(root.record_offset, 0U);
    const bvh::A2rtRecord record = bvh::decode_a2rt(tree_.bytes(), 0, precision_);
    EXPECT_EQ(record.box, tree_.root_box());
    inner(record, tree_.root());
    return records_ + 1;
  }

 private:
  void inner(const bvh::A2rtRecord& record, ChildRef ref) {
    const A2rtNode& node = tree_.node(ref.index());
    EXPECT_EQ(record.group, ref.opens());
    EXPECT_EQ(record.group, node.opens);
    EXPECT_EQ(record.start, node.fetch_offset);
    if (record.group) {
      EXPECT_EQ(tree_.frame(ref.index()).lo, record.box.lo);
      EXPECT_EQ(tree_.frame(ref.index()).scale, record.scale);
    }
    std::uint32_t at = record.start;
    for (std::uint32_t s = 0; s < node.count; ++s) {
      at += child(node, s, at);
    }
    EXPECT_EQ(at, record.end);
  }

  std::uint32_t child(const A2rtNode& node, std::uint32_t slot, std::uint32_t at) {
    ++records_;
    const ChildRef ref = node.children[slot];
    const bvh::A2rtRecord record = bvh::decode_a2rt(tree_.bytes(), at, precision_);
    EXPECT_EQ(record.group, slot < node.group_count);
    if (record.group) {
      EXPECT_EQ(tree_.group_boxes(node).get(slot), record.box);
    } else {
      EXPECT_EQ(tester_.get(tree_.planes(node), slot), record.qbox);
    }
    EXPECT_EQ(record.leaf, ref.is_leaf());
    if (record.leaf) {
      EXPECT_EQ(record.start, ref.first());
      EXPECT_EQ(record.end, ref.first() + ref.count());
    } else {
      EXPECT_EQ(tree_.node(ref.index()).record_offset, at);
      inner(record, ref);
    }
    return record.group ? bvh::a2rt_group_bytes(precision_) : bvh::a2rt_sub_bytes(precision_);
  }

  const A2rtTree& tree_;
  const arith::A2rtPrecision& precision_;
  arith::QBoxTester tester_;
  std::size_t records_ = 0;
};

TEST(Mirror, A2rtTraversesTheBoxesFramesAndRangesOfItsRecords) {
  const Workload w = scene(Shape::kSlivers, 3000);
  for (const std::string knobs :
       {"", "leaf = 'group'", "[precision]\nbox_bits = 12",
        "[precision]\nbox_bits = 5\nscales = 'single'", "[precision]\norigin = 'guard'",
        "[tree]\nbranching = 8\nmax_leaf = 1"}) {
    const std::string toml = "[classify]\narea_ratio = 0.05\n" + knobs;
    TreeUnit<A2rtUnit> unit(
        A2rtUnit(config::Section::from_text(toml, "test"), "a2rt", "", arith::OriginDesign::kWide));
    unit.build(w);
    const StructureStats s = unit.structure();
    A2rtWalk walk(unit.structures().blas[0], unit.unit().precision());
    // The TLAS, one leaf, has no records.
    EXPECT_EQ(walk.run(), s.group_nodes + s.sub_nodes) << toml;
    EXPECT_GT(s.group_nodes, 1U) << toml;
  }
}

TEST(Mirror, Aqb8TraversesTheBoxesWordsAndAnchorsOfItsRecords) {
  const Workload w = scene(Shape::kTorus, 3000);
  for (const std::uint32_t size : {8U, 16U}) {
    const std::string toml = "[layout]\nnode_bytes = " + std::to_string(size);
    TreeUnit<Aqb8Unit> unit(Aqb8Unit(config::Section::from_text(toml, "test")));
    unit.build(w);
    const Aqb8Tree& tree = unit.structures().blas[0];
    const bvh::Aqb8Layout& layout = tree.layout();
    for (std::uint32_t c = 0; c < layout.anchors.size(); ++c) {
      bvh::ByteReader in(layout.anchor_bytes, std::size_t{c} * bvh::kAqb8AnchorBytes);
      for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_EQ(in.f32(), tree.anchor(c).box.lo[a]);
        EXPECT_EQ(in.f32(), tree.anchor(c).box.hi[a]);
      }
      EXPECT_EQ(in.f32(), tree.anchor(c).inv_sx_inv_sw);
      EXPECT_EQ(in.u32(), tree.cluster(c).node_offset);
      EXPECT_EQ(in.u32(), tree.cluster(c).triangle_offset);
    }
    std::size_t seen = 0;
    for (std::uint32_t n = 0; n < tree.node_count(); ++n) {
      const Aqb8Node& node = tree.node(n);
      for (std::uint32_t s = 0; s < node.count; ++s, ++seen) {
        const bvh::Cluster& home = tree.cluster(node.cluster);
        const bvh::Aqb8Record record = bvh::decode_aqb8(layout.node_bytes, size, node.first + s);
        const ChildRef ref = tree.children(n)[s];
        EXPECT_EQ(record.box, tree.box(node.first + s));
        EXPECT_EQ(record.kind == bvh::Aqb8Kind::kLeaf, ref.is_leaf());
        EXPECT_EQ(record.kind == bvh::Aqb8Kind::kSwitch, ref.opens());
        if (ref.is_leaf()) {
          EXPECT_EQ(record.first + (size == 8 ? home.triangle_offset : 0), ref.first());
          EXPECT_EQ(record.count, ref.count());
        } else if (ref.opens()) {
          EXPECT_EQ(record.first, tree.node(ref.index()).cluster);
        } else {
          EXPECT_EQ(record.first + (size == 8 ? home.node_offset : 0),
                    tree.node(ref.index()).first);
        }
      }
    }
    EXPECT_EQ(seen, unit.structure().sub_nodes);
  }
}

// Inner nodes of a BoxTree against `decoded(node, slot)`.
void expect_boxes(const BoxTree& tree,
                  const std::function<Box(std::uint32_t, std::uint32_t)>& decoded) {
  std::size_t seen = 0;
  for (std::uint32_t n = 0; n < tree.node_count(); ++n) {
    for (std::uint32_t s = 0; s < tree.node(n).count; ++s, ++seen) {
      EXPECT_EQ(tree.node(n).boxes.get(s), decoded(n, s));
    }
  }
  EXPECT_GT(seen, 100U);
}

TEST(Mirror, TheBaselineTraversesTheBoxesOfItsRecords) {
  bvh::WideBvh tree = wide(scene(Shape::kSoup, 1500));
  const bvh::Fp32Layout layout = bvh::encode_fp32(tree, 56, 1, "t");
  const BoxTree mirror = BoxTree::mirror(tree, {});
  expect_boxes(mirror, [&](std::uint32_t n, std::uint32_t s) {
    return bvh::decode_fp32(layout.bytes, layout.offset[mirror.node(n).first_record + s]).box;
  });
}

TEST(Mirror, CwbvhTraversesTheDequantizedBoxesOfItsRecords) {
  bvh::WideBvh tree = wide(scene(Shape::kSoup, 1500), {8, 3});
  const std::vector<std::byte> bytes = bvh::encode_cwbvh(tree, "t");
  const BoxTree mirror = BoxTree::mirror(tree, bvh::dequantized_boxes(tree, false, "t"));
  expect_boxes(mirror, [&](std::uint32_t n, std::uint32_t s) {
    return bvh::decode_cwbvh(bytes, 8, n).children[s].box;
  });
}

TEST(Mirror, ClbvhTraversesTheDequantizedBoxesOfItsMultiLeaves) {
  bvh::WideBvh tree = wide(scene(Shape::kSoup, 1500));
  const std::vector<Box> boxes = bvh::dequantized_boxes(tree, true, "t");
  const bvh::WideBvh copy = tree;
  const std::vector<std::uint32_t> number = bvh::number_inner_records(copy);
  const BoxTree mirror = BoxTree::mirror(tree, boxes);
  std::size_t multi = 0;
  for (std::uint32_t i = 0; i < copy.records.size(); ++i) {
    if (!bvh::is_multi_leaf(copy, i)) {
      continue;
    }
    ++multi;
    const bvh::Pow2Node node = bvh::decode_multi_leaf(bvh::encode_multi_leaf(copy, i, "t"));
    for (std::uint32_t s = 0; s < copy.records[i].count; ++s) {
      EXPECT_EQ(mirror.node(number[i]).boxes.get(s), node.children[s].box);
    }
  }
  EXPECT_GT(multi, 10U);
}

}  // namespace
}  // namespace a2rt::rt
