#include "a2rt/rt/box_tree.h"

#include <algorithm>
#include <cmath>

namespace a2rt::rt {

BoxTree BoxTree::mirror(bvh::WideBvh& tree, const std::vector<Box>& boxes) {
  BoxTree result;
  if (tree.empty()) {
    return result;
  }
  const std::vector<std::uint32_t> number = bvh::number_inner_records(tree);
  const auto ref = [&](std::uint32_t i) {
    const bvh::BvhRecord& r = tree.records[i];
    return r.leaf() ? bvh::ChildRef::leaf(r.first, r.count)
                    : bvh::ChildRef::inner(number[i], false);
  };
  result.root_ = ref(0);
  result.nodes_.reserve(tree.inner_count());
  for (const bvh::BvhRecord& r : tree.records) {
    if (r.leaf()) {
      continue;
    }
    BoxNode& node = result.nodes_.emplace_back();
    node.first_record = r.first;
    node.count = static_cast<std::uint8_t>(r.count);
    for (std::uint32_t s = 0; s < r.count; ++s) {
      const Box& box = boxes.empty() ? tree.records[r.first + s].box : boxes[r.first + s];
      node.boxes.put(s, box);
      node.children[s] = ref(r.first + s);
      for (std::size_t a = 0; a < 3; ++a) {
        result.largest_ = std::max({result.largest_, std::fabs(box.lo[a]), std::fabs(box.hi[a])});
      }
    }
  }
  result.records_ = std::move(tree.records);
  return result;
}

}  // namespace a2rt::rt
