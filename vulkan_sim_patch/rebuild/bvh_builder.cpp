#include "rebuild/bvh_builder.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <limits>
#include <thread>
#include <utility>
#include <vector>

namespace a2rt::layer {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr DriverBox kEmpty = {{kInfinity, kInfinity, kInfinity},
                              {-kInfinity, -kInfinity, -kInfinity}};
constexpr int kMostBins = 32;
// Below this many items bins cost more than they find.
constexpr std::size_t kFewItems = 64;
constexpr int kFewBins = 16;
// Subtrees of this share of all items are handed to threads.
constexpr std::size_t kSubtreesPerBuild = 16;
constexpr std::size_t kSmallestTask = 4096;

void grow(DriverBox& box, const DriverBox& other) {
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[axis] = std::min(box.lo[axis], other.lo[axis]);
    box.hi[axis] = std::max(box.hi[axis], other.hi[axis]);
  }
}

float half_area(const DriverBox& box) {
  const float x = box.hi[0] - box.lo[0];
  const float y = box.hi[1] - box.lo[1];
  const float z = box.hi[2] - box.lo[2];
  return x * y + y * z + z * x;
}

// Twice the centroid, which orders and bins as the centroid does. A box that is infinite both ways
// has none; 0 keeps the order of the items strict.
float centroid(const BuildItem& item, int axis) {
  const float sum = item.box.lo[axis] + item.box.hi[axis];
  return sum == sum ? sum : 0.0f;
}

struct CentroidBounds {
  float lo[3] = {kInfinity, kInfinity, kInfinity};
  float hi[3] = {-kInfinity, -kInfinity, -kInfinity};
};

CentroidBounds centroid_bounds(std::span<const BuildItem> items) {
  CentroidBounds bounds;
  for (const BuildItem& item : items) {
    for (int axis = 0; axis < 3; ++axis) {
      const float c = centroid(item, axis);
      bounds.lo[axis] = std::min(bounds.lo[axis], c);
      bounds.hi[axis] = std::max(bounds.hi[axis], c);
    }
  }
  return bounds;
}

// Maps centroids of one axis to bins.
struct Binning {
  float lo = 0;
  float scale = 0;
  int bins = 0;

  int bin(float c) const {
    const float place = (c - lo) * scale;
    // NaN (an infinite centroid) goes to the first bin.
    return place >= static_cast<float>(bins) ? bins - 1 : (place > 0 ? static_cast<int>(place) : 0);
  }
};

struct Split {
  int axis = -1;
  int last_left_bin = 0;
  Binning binning;
  float cost = kInfinity;
};

struct Bin {
  DriverBox box = kEmpty;
  std::uint32_t count = 0;
};

// Best place between two bins of one axis by the surface-area heuristic.
void sweep(const std::array<Bin, kMostBins>& bins, const Binning& binning, int axis, Split& best) {
  std::array<float, kMostBins> right_cost;
  DriverBox box = kEmpty;
  std::uint32_t count = 0;
  const auto cost = [&] { return count == 0 ? 0.0f : half_area(box) * static_cast<float>(count); };
  for (int i = binning.bins - 1; i > 0; --i) {
    const auto at = static_cast<std::size_t>(i);
    if (bins[at].count != 0) {
      grow(box, bins[at].box);
      count += bins[at].count;
    }
    right_cost[at] = count == 0 ? kInfinity : cost();
  }
  box = kEmpty;
  count = 0;
  for (int i = 0; i + 1 < binning.bins; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (bins[at].count != 0) {
      grow(box, bins[at].box);
      count += bins[at].count;
    }
    const float total = count == 0 ? kInfinity : cost() + right_cost[at + 1];
    if (total < best.cost) {
      best = {axis, i, binning, total};
    }
  }
}

Split find_split(std::span<const BuildItem> items) {
  const CentroidBounds bounds = centroid_bounds(items);
  const int bins = items.size() < kFewItems ? kFewBins : kMostBins;
  Split best;
  std::array<Binning, 3> binnings;
  std::array<std::array<Bin, kMostBins>, 3> table{};
  for (int axis = 0; axis < 3; ++axis) {
    const float extent = bounds.hi[axis] - bounds.lo[axis];
    const float scale = static_cast<float>(bins) / extent;
    if (extent > 0 && extent < kInfinity && scale < kInfinity) {
      binnings[static_cast<std::size_t>(axis)] = {bounds.lo[axis], scale, bins};
    }
  }
  for (const BuildItem& item : items) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (binnings[axis].bins != 0) {
        const int at = binnings[axis].bin(centroid(item, static_cast<int>(axis)));
        Bin& bin = table[axis][static_cast<std::size_t>(at)];
        grow(bin.box, item.box);
        ++bin.count;
      }
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (binnings[axis].bins != 0) {
      sweep(table[axis], binnings[axis], static_cast<int>(axis), best);
    }
  }
  return best;
}

// Halves the items along the axis where their centroids spread most.
std::size_t split_in_half(std::span<BuildItem> items) {
  const CentroidBounds bounds = centroid_bounds(items);
  int axis = 0;
  for (int i = 1; i < 3; ++i) {
    if (bounds.hi[i] - bounds.lo[i] > bounds.hi[axis] - bounds.lo[axis]) {
      axis = i;
    }
  }
  const auto half = items.size() / 2;
  // The leaf number decides between equal centroids: one order on every machine.
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
                   [axis](const BuildItem& a, const BuildItem& b) {
                     const float ca = centroid(a, axis);
                     const float cb = centroid(b, axis);
                     return ca < cb || (ca == cb && a.leaf < b.leaf);
                   });
  return half;
}

std::size_t split(std::span<BuildItem> items, std::uint32_t levels_left) {
  if (items.size() == 2) {
    return 1;
  }
  // One level goes to the node itself; each side must still fit in the rest.
  const bool room = depth_needed(items.size()) < levels_left;
  if (room) {
    const Split best = find_split(items);
    if (best.axis >= 0) {
      const auto middle =
          std::partition(items.begin(), items.end(), [&best](const BuildItem& item) {
            return best.binning.bin(centroid(item, best.axis)) <= best.last_left_bin;
          });
      const auto left = static_cast<std::size_t>(middle - items.begin());
      if (left > 0 && left < items.size() && depth_needed(left) < levels_left &&
          depth_needed(items.size() - left) < levels_left) {
        return left;
      }
    }
  }
  return split_in_half(items);
}

DriverBox bounds_of(std::span<const BuildItem> items) {
  DriverBox box = kEmpty;
  for (const BuildItem& item : items) {
    grow(box, item.box);
  }
  return box;
}

struct Subtree {
  std::span<BuildItem> items;
  std::uint32_t node;  // index of its root among the nodes
  std::uint32_t levels_left;
};

class Builder {
 public:
  explicit Builder(const TreeTarget& target) : target_(target) {}

  // Writes the root of the subtree and calls `next` for each child that is a subtree.
  template <class Next>
  void write_node(const Subtree& tree, const Next& next) const {
    const std::size_t left = split(tree.items, tree.levels_left);
    const std::array sides = {tree.items.first(left), tree.items.subspan(left)};
    const std::array nodes = {tree.node + 1, tree.node + static_cast<std::uint32_t>(left)};
    DriverBoxNode out{};
    for (std::size_t i = 0; i < 2; ++i) {
      out.bounds[i] = bounds_of(sides[i]);
      if (sides[i].size() == 1) {
        out.children[i] =
            (target_.leaves_offset + sides[i][0].leaf * target_.leaf_bytes) | target_.leaf_type;
      } else {
        out.children[i] =
            (target_.nodes_offset + nodes[i] * static_cast<std::uint32_t>(sizeof(DriverBoxNode))) |
            kBoxNodeType;
        next(Subtree{sides[i], nodes[i], tree.levels_left - 1});
      }
    }
    target_.nodes[tree.node] = out;
  }

  void build(const Subtree& tree) const {
    write_node(tree, [this](const Subtree& child) { build(child); });
  }

 private:
  TreeTarget target_;
};

}  // namespace

std::uint32_t depth_needed(std::size_t leaves) {
  return leaves < 2 ? 0 : static_cast<std::uint32_t>(std::bit_width(leaves - 1));
}

void build_sah(std::span<BuildItem> items, const TreeTarget& target, std::uint32_t depth_limit,
               unsigned threads) {
  const Builder builder(target);
  const std::size_t task_size = std::max(items.size() / kSubtreesPerBuild, kSmallestTask);
  std::vector<Subtree> open = {{items, 0, depth_limit}};
  std::vector<Subtree> tasks;
  while (!open.empty()) {
    const Subtree tree = open.back();
    open.pop_back();
    if (tree.items.size() <= task_size) {
      tasks.push_back(tree);
    } else {
      builder.write_node(tree, [&open](const Subtree& child) { open.push_back(child); });
    }
  }
  std::atomic<std::size_t> next_task{0};
  const auto work = [&] {
    for (std::size_t i = next_task++; i < tasks.size(); i = next_task++) {
      builder.build(tasks[i]);
    }
  };
  std::vector<std::thread> workers;
  for (unsigned i = 1; i < std::min<std::size_t>(threads, tasks.size()); ++i) {
    workers.emplace_back(work);
  }
  work();
  for (std::thread& worker : workers) {
    worker.join();
  }
}

}  // namespace a2rt::layer
