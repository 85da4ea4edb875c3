#include "a2rt/rt/a2rt_tree.h"

#include <algorithm>
#include <cmath>

namespace a2rt::rt {

A2rtTree A2rtTree::mirror(bvh::WideBvh& tree, const bvh::Classification& classes,
                          bvh::A2rtLayout layout, const arith::QBoxTester& tester,
                          const arith::A2rtPrecision& precision) {
  A2rtTree result;
  result.layout_ = std::move(layout);
  if (tree.empty()) {
    return result;
  }
  const std::vector<std::uint32_t> number = bvh::number_inner_records(tree);
  std::vector<bvh::ChildRef> refs(tree.records.size());
  std::vector<std::uint32_t> frame_of(tree.records.size(), 0);
  for (std::uint32_t i = 0; i < tree.records.size(); ++i) {
    const bvh::BvhRecord& r = tree.records[i];
    refs[i] = r.leaf() ? bvh::ChildRef::leaf(r.first, r.count)
                       : bvh::ChildRef::inner(number[i], classes.is_group[i] != 0);
  }
  result.root_ = refs[0];
  result.stride_ = 1 + (tester.block_bytes() + sizeof(Line) - 1) / sizeof(Line);
  result.lines_.resize(tree.inner_count() * result.stride_);
  for (std::uint32_t i = 0; i < tree.records.size(); ++i) {
    const bvh::BvhRecord& r = tree.records[i];
    if (r.leaf()) {
      continue;
    }
    if (classes.is_group[i] != 0) {
      frame_of[i] = static_cast<std::uint32_t>(result.frames_.size());
      result.frames_.push_back(
          {arith::make_group_frame(r.box, precision), result.layout_.offset[i]});
    }
    result.add_node(tree, classes, refs, i, frame_of[classes.group[i]], tester, number[i]);
  }
  const Box& box = tree.records[0].box;
  for (std::size_t a = 0; a < 3; ++a) {
    result.largest_ = std::max({result.largest_, std::fabs(box.lo[a]), std::fabs(box.hi[a])});
  }
  result.records_ = std::move(tree.records);
  result.layout_.offset = {};
  result.layout_.qbox = {};
  return result;
}

void A2rtTree::add_node(const bvh::WideBvh& tree, const bvh::Classification& classes,
                        const std::vector<bvh::ChildRef>& refs, std::uint32_t record,
                        std::uint32_t frame, const arith::QBoxTester& tester, std::uint32_t index) {
  const bvh::BvhRecord& r = tree.records[record];
  A2rtNode& node = *::new (lines_.data() + index * stride_) A2rtNode;
  tester.clear(node.planes());
  node.frame = frame;
  node.first_record = r.first;
  node.fetch_offset = layout_.offset[r.first];
  node.count = static_cast<std::uint8_t>(r.count);
  for (std::uint32_t s = 0; s < r.count; ++s) {
    const std::uint32_t child = r.first + s;
    node.children[s] = refs[child];
    if (classes.is_group[child] == 0) {
      tester.put(node.planes(), s, layout_.qbox[child]);
      continue;
    }
    if (node.group_count++ == 0) {
      node.group_block = static_cast<std::uint32_t>(group_boxes_.size());
      group_boxes_.emplace_back();
    }
    group_boxes_.back().put(s, tree.records[child].box);
  }
}

}  // namespace a2rt::rt
