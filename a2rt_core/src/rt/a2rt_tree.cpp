#include "a2rt/rt/a2rt_tree.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace a2rt::rt {

// Builds the lines while the encoder writes the records. A node gets its lines when its record is
// written; its children come later, in the same order.
class A2rtTree::Mirror : public bvh::A2rtRecordSink {
 public:
  Mirror(A2rtTree& tree, const bvh::WideBvh& bvh, const bvh::Classification& classes,
         const arith::QBoxTester& tester)
      : tree_(tree),
        bvh_(bvh),
        classes_(classes),
        tester_(tester),
        no_planes_(tester.block_bytes()) {
    tester.clear(no_planes_.data());
    const std::size_t planes = (tester.block_bytes() + sizeof(Line) - 1) / sizeof(Line);
    tree.frame_line_ = 1 + planes;
    // Leaves may open groups, too, but have no lines.
    std::uint64_t opening = 0;
    for (std::size_t i = 0; i < bvh.records.size(); ++i) {
      opening += classes.is_group[i] != 0 && !bvh.records[i].leaf() ? 1U : 0U;
    }
    first_lines_.reserve(classes.inner_nodes);
    tree.lines_.resize(classes.inner_nodes * tree.frame_line_ + opening +
                       classes.group_parents * kBoxLines);
  }

  void next_parent() override { parent_line_ = first_lines_[parents_++]; }

  void group(std::uint32_t record, std::uint32_t offset, std::uint32_t children,
             const arith::GroupFrame& frame) override {
    const bvh::ChildRef ref = add(record, offset, children);
    if (!ref.is_leaf()) {
      ::new (line(ref.index() + tree_.frame_line_)) arith::GroupFrame(frame);
    }
    if (record == 0) {
      tree_.root_ = ref;
      return;
    }
    A2rtNode& parent = parent_node();
    const std::uint32_t slot = record - parent.first_record;
    parent.children[slot] = ref;
    if (parent.group_count++ == 0) {
      ::new (boxes_line(parent)) arith::BoxBlock;
    }
    boxes(parent).put(slot, bvh_.records[record].box);
  }

  void sub(std::uint32_t record, std::uint32_t offset, std::uint32_t children,
           const arith::QuantizedBox& box) override {
    const bvh::ChildRef ref = add(record, offset, children);
    A2rtNode& parent = parent_node();
    const std::uint32_t slot = record - parent.first_record;
    parent.children[slot] = ref;
    tester_.put(line(parent_line_ + 1), slot, box);
  }

 private:
  static constexpr std::size_t kBoxLines = sizeof(arith::BoxBlock) / sizeof(Line);
  static_assert(sizeof(arith::BoxBlock) % sizeof(Line) == 0);

  std::byte* line(std::size_t index) { return tree_.lines_[index].bytes; }
  A2rtNode& parent_node() { return *std::launder(reinterpret_cast<A2rtNode*>(line(parent_line_))); }
  std::byte* boxes_line(const A2rtNode& parent) {
    return line(parent_line_ + tree_.frame_line_ + (parent.opens ? 1 : 0));
  }
  arith::BoxBlock& boxes(const A2rtNode& parent) {
    return *std::launder(reinterpret_cast<arith::BoxBlock*>(boxes_line(parent)));
  }

  // Lines of an inner record's node.
  std::size_t lines_of(std::uint32_t record) const {
    return tree_.frame_line_ + (classes_.is_group[record] != 0 ? 1U : 0U) +
           (classes_.is_group[bvh_.records[record].first] != 0 ? kBoxLines : 0U);
  }

  // The record's reference; makes its node if it has one.
  bvh::ChildRef add(std::uint32_t record, std::uint32_t offset, std::uint32_t children) {
    const bvh::BvhRecord& r = bvh_.records[record];
    if (r.leaf()) {
      return bvh::ChildRef::leaf(r.first, r.count);
    }
    A2rtNode& node = *::new (line(next_line_)) A2rtNode;
    node.first_record = r.first;
    node.fetch_offset = children;
    node.record_offset = offset;
    node.count = static_cast<std::uint8_t>(r.count);
    node.opens = classes_.is_group[record] != 0;
    std::memcpy(line(next_line_ + 1), no_planes_.data(), no_planes_.size());
    const auto index = static_cast<std::uint32_t>(next_line_);
    first_lines_.push_back(index);
    next_line_ += lines_of(record);
    return bvh::ChildRef::inner(index, node.opens);
  }

  A2rtTree& tree_;
  const bvh::WideBvh& bvh_;
  const bvh::Classification& classes_;
  const arith::QBoxTester& tester_;
  std::vector<std::byte> no_planes_;
  std::vector<std::uint32_t> first_lines_;  // of the nodes, in the order made
  std::size_t next_line_ = 0, parents_ = 0;
  std::size_t parent_line_ = 0;  // of the node whose children come
};

A2rtTree A2rtTree::encode(bvh::WideBvh& tree, const bvh::Classification& classes,
                          const arith::QBoxTester& tester, const arith::A2rtPrecision& precision,
                          std::uint32_t sibling_alignment, const std::string& what) {
  A2rtTree result;
  if (tree.empty()) {
    return result;
  }
  const bvh::BvhRecord& root = tree.records[0];
  if (root.leaf()) {
    result.root_ = bvh::ChildRef::leaf(root.first, root.count);
  } else {
    Mirror mirror(result, tree, classes, tester);
    result.bytes_ = bvh::encode_a2rt(tree, classes, precision, sibling_alignment, what, &mirror);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    result.largest_ =
        std::max({result.largest_, std::fabs(root.box.lo[a]), std::fabs(root.box.hi[a])});
  }
  result.records_ = std::move(tree.records);
  return result;
}

}  // namespace a2rt::rt
