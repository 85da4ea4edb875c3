#include "a2rt/bvh/wide_bvh.h"

#include <algorithm>
#include <cmath>

#include "a2rt/base/error.h"

namespace a2rt::bvh {

std::size_t WideBvh::leaf_count() const {
  return static_cast<std::size_t>(
      std::count_if(records.begin(), records.end(), [](const BvhRecord& r) { return r.leaf(); }));
}

std::size_t WideBvh::inner_count() const { return records.size() - leaf_count(); }

double half_area(const Box& box) {
  const double dx = static_cast<double>(box.hi.x) - static_cast<double>(box.lo.x);
  const double dy = static_cast<double>(box.hi.y) - static_cast<double>(box.lo.y);
  const double dz = static_cast<double>(box.hi.z) - static_cast<double>(box.lo.z);
  return (dx + dy) * dz + dx * dy;
}

double sah_cost(const WideBvh& bvh) {
  if (bvh.empty() || half_area(bvh.records[0].box) <= 0) {
    return 0;
  }
  double cost = 0;
  for (const BvhRecord& r : bvh.records) {
    cost += half_area(r.box) * (r.leaf() ? r.count : 1);
  }
  return cost / half_area(bvh.records[0].box);
}

std::vector<std::uint32_t> number_inner_records(const WideBvh& bvh) {
  std::vector<std::uint32_t> number(bvh.records.size(), kNoInner);
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < bvh.records.size(); ++i) {
    if (!bvh.records[i].leaf()) {
      number[i] = next++;
    }
  }
  return number;
}

namespace {

bool holds(const Box& outer, const Box& inner) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(outer.lo[a] <= inner.lo[a] && inner.hi[a] <= outer.hi[a])) {
      return false;
    }
  }
  return true;
}

bool finite(const Box& box) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (!std::isfinite(box.lo[a]) || !std::isfinite(box.hi[a])) {
      return false;
    }
  }
  return true;
}

}  // namespace

void check_boxes(const WideBvh& bvh, const std::string& what) {
  for (std::size_t i = 0; i < bvh.records.size(); ++i) {
    const BvhRecord& r = bvh.records[i];
    if (!finite(r.box) || !r.box.valid()) {
      throw UserError(what + ", node " + std::to_string(i) +
                      ": its box is inverted, empty or not finite; rebuild the tree from finite "
                      "primitives");
    }
    for (std::size_t c = 0; !r.leaf() && c < r.count; ++c) {
      if (!holds(r.box, bvh.records[r.first + c].box)) {
        throw UserError(what + ", node " + std::to_string(r.first + c) +
                        ": its box leaves the box of its parent, node " + std::to_string(i));
      }
    }
  }
}

}  // namespace a2rt::bvh
