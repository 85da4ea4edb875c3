#include "a2rt/bvh/classify.h"

#include <algorithm>
#include <array>
#include <span>

namespace a2rt::bvh {
namespace {

// Thresholds of one group, so that a child costs comparisons only.
struct Thresholds {
  double area;
  std::array<double, 3> length;
};

double length(const Box& box, std::size_t axis) {
  return static_cast<double>(box.hi[axis]) - static_cast<double>(box.lo[axis]);
}

Thresholds thresholds(const Box& group, const ClassifyConfig& config) {
  // A zero length or area gives the threshold zero, which every child meets.
  return {config.area_ratio * half_area(group),
          {config.length_ratio * length(group, 0), config.length_ratio * length(group, 1),
           config.length_ratio * length(group, 2)}};
}

bool is_sub(const Box& child, const Thresholds& t) {
  return half_area(child) >= t.area && length(child, 0) >= t.length[0] &&
         length(child, 1) >= t.length[1] && length(child, 2) >= t.length[2];
}

// Groups before sub nodes, else in the order they came.
void order_siblings(std::span<BvhRecord> siblings, std::span<std::uint8_t> is_group) {
  std::array<BvhRecord, kMaxWidth> subs;
  std::size_t groups = 0, sub_count = 0;
  for (std::size_t s = 0; s < siblings.size(); ++s) {
    if (is_group[s] != 0) {
      siblings[groups++] = siblings[s];
    } else {
      subs[sub_count++] = siblings[s];
    }
  }
  std::copy_n(subs.begin(), sub_count, siblings.begin() + static_cast<std::ptrdiff_t>(groups));
  std::fill_n(is_group.begin(), groups, std::uint8_t{1});
  std::fill(is_group.begin() + static_cast<std::ptrdiff_t>(groups), is_group.end(),
            std::uint8_t{0});
}

}  // namespace

Classification classify(WideBvh& bvh, const ClassifyConfig& config) {
  Classification result;
  const std::size_t n = bvh.records.size();
  result.is_group.assign(n, 0);
  result.group.assign(n, 0);
  if (n == 0 || bvh.records[0].leaf()) {
    return result;
  }
  result.is_group[0] = 1;
  result.group_nodes = 1;
  for (std::uint32_t i = 0; i < n; ++i) {
    const BvhRecord& parent = bvh.records[i];
    if (parent.leaf()) {
      continue;
    }
    const std::uint32_t group = result.group[i];
    const Thresholds limit = thresholds(bvh.records[group].box, config);
    const std::span siblings(bvh.records.data() + parent.first, parent.count);
    const std::span is_group(result.is_group.data() + parent.first, parent.count);
    std::size_t groups = 0;
    for (std::size_t s = 0; s < siblings.size(); ++s) {
      const BvhRecord& child = siblings[s];
      const bool stays =
          (child.leaf() && config.leaf == LeafPolicy::kSub) || is_sub(child.box, limit);
      is_group[s] = stays ? 0 : 1;
      groups += stays ? 0U : 1U;
    }
    ++result.inner_nodes;
    if (groups > 0) {
      ++result.group_parents;
      order_siblings(siblings, is_group);
    }
    for (std::uint32_t s = 0; s < siblings.size(); ++s) {
      result.group[parent.first + s] = is_group[s] != 0 ? parent.first + s : group;
    }
    result.group_nodes += groups;
    result.sub_nodes += siblings.size() - groups;
  }
  return result;
}

}  // namespace a2rt::bvh
