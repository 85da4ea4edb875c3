#include "a2rt/rt/aqb8_tree.h"

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
      result.nodes_.push_back({clusters.position[r.first], clusters.cluster[i], r.first, r.count});
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
