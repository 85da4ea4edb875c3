#include <gtest/gtest.h>

#include "a2rt/base/error.h"
#include "a2rt/bvh/child_ref.h"
#include "a2rt/bvh/layout_a2rt.h"
#include "a2rt/bvh/layout_aqb8.h"
#include "a2rt/bvh/layout_fp32.h"
#include "a2rt/bvh/layout_pow2.h"
#include "shapes.h"

namespace a2rt::bvh {
namespace {

using synthetic::Shape;

bool holds(const Box& outer, const Box& inner) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (outer.lo[a] > inner.lo[a] || outer.hi[a] < inner.hi[a]) {
      return false;
    }
  }
  return true;
}

TEST(Fp32Layout, DecodesToWhatWasEncodedAndNamesItsChildren) {
  const WideBvh bvh = build(Shape::kTorus, 900);
  for (const std::uint32_t size : {33U, 56U, 64U}) {
    for (const std::uint32_t alignment : {1U, 64U}) {
      const Fp32Layout layout = encode_fp32(bvh, size, alignment, "t");
      for (std::size_t i = 0; i < bvh.records.size(); ++i) {
        const BvhRecord& r = bvh.records[i];
        const Fp32Record d = decode_fp32(layout.bytes, layout.offset[i]);
        EXPECT_EQ(d.box, r.box);
        EXPECT_EQ(d.leaf, r.leaf());
        EXPECT_EQ(d.start, r.leaf() ? r.first : layout.offset[r.first]);
        EXPECT_EQ(d.end - d.start, r.leaf() ? r.count : r.count * size);
        EXPECT_EQ(r.leaf() ? 0 : layout.offset[r.first] % alignment, 0U);
      }
    }
  }
  EXPECT_THROW(encode_fp32(bvh, 32, 1, "t"), UserError);
}

// What the encoder said about each record while it wrote it.
struct Written : A2rtRecordSink {
  struct Item {
    bool group = false;
    std::uint32_t offset = 0, children = 0;
    arith::GroupFrame frame;
    arith::QuantizedBox box;
  };
  std::vector<Item> items;  // by record
  std::uint32_t count = 0, last_offset = 0;
  explicit Written(const WideBvh& bvh) : items(bvh.records.size()) {}
  void next_parent() override {}
  void group(std::uint32_t record, std::uint32_t offset, std::uint32_t children,
             const arith::GroupFrame& frame) override {
    add(record, {true, offset, children, frame, {}});
  }
  void sub(std::uint32_t record, std::uint32_t offset, std::uint32_t children,
           const arith::QuantizedBox& box) override {
    add(record, {false, offset, children, {}, box});
  }
  void add(std::uint32_t record, const Item& item) {
    EXPECT_TRUE(count == 0 || item.offset > last_offset);
    last_offset = item.offset;
    ++count;
    items.at(record) = item;
  }
};

TEST(A2rtLayout, GroupsTake45BytesAndSubNodes15) {
  WideBvh bvh = build(Shape::kSoup, 2000);
  const Classification c = classify(bvh, {0.02, 0.02, LeafPolicy::kSub});
  arith::A2rtPrecision precision;
  EXPECT_EQ(a2rt_group_bytes(precision), 45U);
  EXPECT_EQ(a2rt_sub_bytes(precision), 15U);
  EXPECT_EQ(encode_a2rt(bvh, c, precision, 1, "t").size(), 45 * c.group_nodes + 15 * c.sub_nodes);
  precision.scales = arith::ScaleSharing::kSingle;  // stores one scale instead of three
  EXPECT_EQ(encode_a2rt(bvh, c, precision, 1, "t").size(), 37 * c.group_nodes + 15 * c.sub_nodes);
}

struct A2rtVariant {
  int bits;
  LeafPolicy leaf;
  arith::ScaleSharing scales;
  std::uint32_t alignment;
};

TEST(A2rtLayout, DecodesToWhatWasEncodedForEveryVariant) {
  using enum arith::ScaleSharing;
  for (const A2rtVariant& v : {A2rtVariant{4, LeafPolicy::kSub, kPerAxis, 1},
                               {6, LeafPolicy::kGroup, kPerAxis, 32},
                               {8, LeafPolicy::kSub, kPerAxis, 1},
                               {8, LeafPolicy::kGroup, kSingle, 1},
                               {8, LeafPolicy::kSub, kPerAxis, 64},
                               {10, LeafPolicy::kSub, kSingle, 32},
                               {12, LeafPolicy::kGroup, kPerAxis, 1}}) {
    WideBvh bvh = build(Shape::kSlivers, 800);
    const Classification c = classify(bvh, {0.05, 0.01, v.leaf});
    arith::A2rtPrecision precision;
    precision.box_bits = v.bits;
    precision.scales = v.scales;
    Written written(bvh);
    const std::vector<std::byte> bytes = encode_a2rt(bvh, c, precision, v.alignment, "t", &written);
    ASSERT_EQ(written.count, bvh.records.size());
    for (std::uint32_t i = 0; i < bvh.records.size(); ++i) {
      const BvhRecord& r = bvh.records[i];
      const Written::Item& w = written.items[i];
      const A2rtRecord d = decode_a2rt(bytes, w.offset, precision);
      ASSERT_EQ(d.group, c.is_group[i] != 0);
      ASSERT_EQ(d.group, w.group);
      EXPECT_EQ(d.leaf, r.leaf());
      if (d.group) {
        EXPECT_EQ(d.box, r.box);
        EXPECT_EQ(d.scale, arith::make_group_frame(r.box, precision).scale);
        EXPECT_EQ(d.scale, w.frame.scale);
      } else {
        EXPECT_EQ(d.qbox, w.box);
      }
      EXPECT_EQ(d.start, w.children);
      EXPECT_EQ(d.start, r.leaf() ? r.first : written.items[r.first].offset);
      EXPECT_EQ(r.leaf() ? 0 : d.start % v.alignment, 0U);
    }
  }
}

// A reader that has nothing but the bytes finds every record by walking sibling ranges.
TEST(A2rtLayout, BytesAloneDescribeTheTree) {
  WideBvh bvh = build(Shape::kTorus, 1200);
  const Classification c = classify(bvh, {0.01, 0.05, LeafPolicy::kSub});
  const arith::A2rtPrecision precision;
  const std::vector<std::byte> bytes = encode_a2rt(bvh, c, precision, 1, "t");
  std::size_t records = 0, primitives = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges = {{0, a2rt_group_bytes(precision)}};
  while (!ranges.empty()) {
    auto [at, end] = ranges.back();
    ranges.pop_back();
    while (at < end) {
      const A2rtRecord r = decode_a2rt(bytes, at, precision);
      ++records;
      if (r.leaf) {
        primitives += r.end - r.start;
      } else {
        ranges.emplace_back(r.start, r.end);
      }
      at += r.group ? a2rt_group_bytes(precision) : a2rt_sub_bytes(precision);
    }
    EXPECT_EQ(at, end);
  }
  EXPECT_EQ(records, bvh.records.size());
  EXPECT_EQ(primitives, bvh.order.size());
}

TEST(A2rtLayout, IdByteHasThePapersBits) {
  WideBvh bvh = build(Shape::kSoup, 600);
  const Classification c = classify(bvh, {0.05, 0.05, LeafPolicy::kSub});
  Written written(bvh);
  const std::vector<std::byte> bytes = encode_a2rt(bvh, c, {}, 1, "t", &written);
  for (std::uint32_t i = 0; i < bvh.records.size(); ++i) {
    const int expected = c.is_group[i] != 0 ? 0x80 : bvh.records[i].leaf() ? 0x7f : 0x00;
    EXPECT_EQ(static_cast<int>(bytes[written.items[i].offset]), expected);
  }
}

TEST(A2rtLayout, RefusesAnInvertedBoxAndNamesTheNode) {
  WideBvh bvh = build(Shape::kSoup, 300);
  const Classification c = classify(bvh, {});
  std::swap(bvh.records[9].box.lo.x, bvh.records[9].box.hi.x);
  try {
    (void)encode_a2rt(bvh, c, {}, 1, "BLAS 2");
    FAIL() << "accepted";
  } catch (const UserError& e) {
    EXPECT_NE(std::string(e.what()).find("BLAS 2, node 9"), std::string::npos) << e.what();
  }
}

TEST(Aqb8Layout, BothNodeSizesDecodeToTheTree) {
  WideBvh bvh = build(Shape::kTorus, 2500);
  ClusterConfig config;
  config.capacity = kAqb8WordCapacity;
  Clustering c = cluster_aqb8(bvh, config);
  adopt_cluster_order(bvh, c);
  for (const std::uint32_t size : {8U, 16U}) {
    const Aqb8Layout layout = encode_aqb8(bvh, c, size, "t");
    EXPECT_EQ(layout.anchor_bytes.size(), 36 * c.clusters.size());
    EXPECT_EQ(layout.node_bytes.size(), size * c.order.size());
    for (const Cluster& home : c.clusters) {
      for (std::uint32_t p = home.node_offset; p < home.node_offset + home.node_count; ++p) {
        const std::uint32_t i = c.order[p];
        const BvhRecord& r = bvh.records[i];
        const Aqb8Record d = decode_aqb8(layout.node_bytes, size, p);
        EXPECT_EQ(d.box, arith::quantize_aqb8(
                             r.box, arith::make_aqb8_anchor(bvh.records[home.anchor].box)));
        if (r.leaf()) {
          EXPECT_EQ(d.kind, Aqb8Kind::kLeaf);
          EXPECT_EQ(d.count, r.count);
          EXPECT_EQ(d.first + (size == 8 ? home.triangle_offset : 0), r.first);
        } else if (c.is_switch[i] != 0) {
          EXPECT_EQ(d.kind, Aqb8Kind::kSwitch);
          EXPECT_EQ(d.first, c.cluster[i]);
        } else {
          EXPECT_EQ(d.kind, Aqb8Kind::kInner);
          EXPECT_EQ(d.first + (size == 8 ? home.node_offset : 0), c.position[r.first]);
        }
      }
    }
  }
  EXPECT_THROW(encode_aqb8(bvh, c, 12, "t"), UserError);
}

TEST(CwbvhLayout, DecodedChildrenHoldTheExactBoxesAndKeepTheirLinks) {
  for (const unsigned width : {6U, 8U}) {
    const WideBvh bvh = build(Shape::kTorus, 1500, {width, 3});
    const std::vector<std::byte> bytes = encode_cwbvh(bvh, "t");
    EXPECT_EQ(bytes.size(), bvh.inner_count() * (width == 8 ? 80 : 66));
    const std::vector<Box> boxes = dequantized_boxes(bvh, false, "t");
    const std::vector<std::uint32_t> number = number_inner_records(bvh);
    for (std::uint32_t i = 0; i < bvh.records.size(); ++i) {
      const BvhRecord& r = bvh.records[i];
      if (r.leaf()) {
        continue;
      }
      const Pow2Node node = decode_cwbvh(bytes, width, number[i]);
      ASSERT_EQ(node.children.size(), r.count);
      for (std::uint32_t s = 0; s < r.count; ++s) {
        const BvhRecord& child = bvh.records[r.first + s];
        EXPECT_EQ(node.children[s].box, boxes[r.first + s]);
        EXPECT_TRUE(holds(node.children[s].box, child.box));
        EXPECT_EQ(node.children[s].leaf, child.leaf());
        EXPECT_EQ(node.children[s].first, child.leaf() ? child.first : number[r.first + s]);
        EXPECT_EQ(node.children[s].count, child.leaf() ? child.count : 0U);
      }
    }
  }
}

TEST(CwbvhLayout, RefusesLeavesItsFieldCannotHold) {
  // Identical triangles cannot be told apart, so their leaves are full.
  const std::vector<Triangle> same(60, Triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
  const WideBvh bvh = WideBuilder({6, 7}).build(std::span<const Triangle>(same));
  EXPECT_THROW(encode_cwbvh(bvh, "t"), UserError);
}

TEST(MultiLeaf, DecodesToBoxesThatHoldTheLeavesAndTheirTriangles) {
  const WideBvh bvh = build(Shape::kSoup, 1500);
  std::size_t seen = 0;
  for (std::uint32_t i = 0; i < bvh.records.size(); ++i) {
    if (!is_multi_leaf(bvh, i)) {
      continue;
    }
    ++seen;
    const BvhRecord& r = bvh.records[i];
    const std::vector<std::byte> bytes = encode_multi_leaf(bvh, i, "t");
    EXPECT_EQ(bytes.size(), clbvh_multi_leaf_bytes(r.count));
    const Pow2Node node = decode_multi_leaf(bytes);
    ASSERT_EQ(node.children.size(), r.count);
    for (std::uint32_t s = 0; s < r.count; ++s) {
      EXPECT_TRUE(holds(node.children[s].box, bvh.records[r.first + s].box));
      EXPECT_EQ(node.children[s].first, bvh.records[r.first + s].first);
      EXPECT_EQ(node.children[s].count, bvh.records[r.first + s].count);
    }
  }
  EXPECT_GT(seen, 10U);
}

TEST(ChildRef, KeepsEveryField) {
  for (const std::uint32_t first : {0U, 1U, ChildRef::kMostFirst}) {
    for (const std::uint32_t count : {1U, 7U, 16U}) {
      const ChildRef leaf = ChildRef::leaf(first, count);
      EXPECT_TRUE(leaf.is_leaf());
      EXPECT_FALSE(leaf.opens());
      EXPECT_EQ(leaf.first(), first);
      EXPECT_EQ(leaf.count(), count);
    }
  }
  const ChildRef inner = ChildRef::inner(ChildRef::kMostInner, true);
  EXPECT_FALSE(inner.is_leaf());
  EXPECT_TRUE(inner.opens());
  EXPECT_EQ(inner.index(), ChildRef::kMostInner);
  EXPECT_FALSE(ChildRef::inner(3, false).opens());
  EXPECT_THROW(ChildRef::leaf(ChildRef::kMostFirst + 1, 1), UserError);
}

}  // namespace
}  // namespace a2rt::bvh
