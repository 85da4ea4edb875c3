#include "a2rt/rt/aqb8_tree.h"

#include <algorithm>

namespace a2rt::rt {

Aqb8Tree Aqb8Tree::mirror(bvh::WideBvh& tree, const bvh::Clustering& clusters,
                          bvh::Aqb8Layout layout) {
  Aqb8Tree result;
  result.layout_ = std::move(layout);
  result.clusters_ = clusters.clusters;
  if (tree.empty()) {
    return result;
  }
  const std::vector<std::uint32_t> number = bvh::number_inner_records(tree);
  const auto ref = [&](std::uint32_t i) {
    const bvh::BvhRecord& r = tree.records[i];
    return r.leaf() ? bvh::ChildRef::leaf(r.first, r.count)
                    : bvh::ChildRef::inner(number[i], clusters.is_switch[i] != 0);
  };
  result.root_ = ref(0);
  result.nodes_.reserve(tree.inner_count());
  for (std::uint32_t i = 0; i < tree.records.size(); ++i) {
    const bvh::BvhRecord& r = tree.records[i];
    if (!r.leaf()) {
      Aqb8Node node{{}, clusters.position[r.first], clusters.cluster[i], r.first, r.count};
      const std::size_t boxes = result.layout_.boxes.size() - node.first;
      for (std::size_t s = 0; s < std::min(boxes, arith::Aqb8Block::kWidth); ++s) {
        node.boxes.put(s, result.layout_.boxes[node.first + s]);
      }
      result.nodes_.push_back(node);
    }
  }
  result.refs_.reserve(clusters.order.size());
  for (const std::uint32_t record : clusters.order) {
    result.refs_.push_back(ref(record));
  }
  result.records_ = std::move(tree.records);
  return result;
}

}  // namespace a2rt::rt
