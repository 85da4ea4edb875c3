#include "a2rt/bvh/aqb8_clusters.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "a2rt/arith/aqb8_arith.h"
#include "a2rt/base/error.h"
#include "a2rt/workload/workload.h"

namespace a2rt::bvh {
namespace {

// Reference box with its scale, so that a table entry costs no division by the extent.
struct Reference {
  Vec3 lo;
  float sx;
  float levels;
};

Reference reference(const Box& anchor, int levels) {
  const float x = anchor.hi.x - anchor.lo.x, y = anchor.hi.y - anchor.lo.y;
  const float z = anchor.hi.z - anchor.lo.z;
  const auto most = static_cast<float>(levels);
  return {anchor.lo, std::max({x, y, z}) / most, most};
}

double area(const Box& box, const Reference& ref) {
  if (!(ref.sx > 0)) {
    return 0;  // all boxes of a point-like anchor are that point
  }
  double d[3];
  for (std::size_t a = 0; a < 3; ++a) {
    const float lo = std::floor((box.lo[a] - ref.lo[a]) / ref.sx);
    const float hi = std::ceil((box.hi[a] - ref.lo[a]) / ref.sx);
    d[a] = static_cast<double>(ref.sx) *
           static_cast<double>(std::min(hi, ref.levels) - std::min(lo, ref.levels));
  }
  return (d[0] + d[1]) * d[2] + d[0] * d[1];
}

// The dynamic program. Tables live on a path-shaped stack: for the node at depth d, row d holds the
// sums of T(child | ancestor) over the children finished so far.
class Program {
 public:
  Program(const WideBvh& bvh, const ClusterConfig& config)
      : bvh_(bvh), config_(config), offset_(bvh.records.size(), 0) {}

  void run() {
    std::uint64_t bits = 0;
    const std::vector<std::uint16_t> depth = depths();
    for (std::size_t i = 0; i < depth.size(); ++i) {
      offset_[i] = bits;
      bits += bvh_.records[i].leaf() ? 0U : depth[i];
    }
    choice_.assign(bits, false);
    rows_.assign(bvh_.depth + 2U, std::vector<double>(bvh_.depth + 2U, 0.0));
    path_.resize(bvh_.depth + 2U);
    root_area_ = area(bvh_.records[0].box, reference(bvh_.records[0].box, levels()));
    solve(0, 0);
  }

  // Whether `record` switches when the anchor is its ancestor at `anchor_depth`.
  bool switches(std::uint32_t record, std::uint32_t anchor_depth) const {
    return choice_[offset_[record] + anchor_depth];
  }
  double cost() const {
    return rows_[0][0] + (2 * config_.t_trv_int + config_.t_switch) * root_area_;
  }

 private:
  int levels() const { return config_.precision.levels(); }

  std::vector<std::uint16_t> depths() const {
    std::vector<std::uint16_t> depth(bvh_.records.size(), 0);
    for (std::size_t i = 0; i < bvh_.records.size(); ++i) {
      const BvhRecord& r = bvh_.records[i];
      for (std::size_t c = 0; !r.leaf() && c < r.count; ++c) {
        depth[r.first + c] = static_cast<std::uint16_t>(depth[i] + 1);
      }
    }
    return depth;
  }

  // Adds T(v | ancestor k) for k < d to row d - 1; rows_[d][k] collects the children's sums, k <= d
  // (k = d is v itself as the anchor). Recursion depth is the tree's, at most some tens.
  void solve(std::uint32_t v, std::uint32_t d) {
    const BvhRecord& r = bvh_.records[v];
    if (r.leaf()) {
      for (std::uint32_t k = 0; k < d; ++k) {
        const double count = config_.leaf_count ? r.count : 1;
        rows_[d - 1][k] += config_.t_ist * count * area(r.box, path_[k]);
      }
      return;
    }
    std::vector<double>& sums = rows_[d];
    std::fill(sums.begin(), sums.begin() + d + 1, 0.0);
    path_[d] = reference(r.box, levels());
    for (std::uint32_t c = 0; c < r.count; ++c) {
      solve(r.first + c, d + 1);
    }
    for (std::uint32_t k = 0; k < d; ++k) {
      const double a = area(r.box, path_[k]);
      const double stay = 2 * config_.t_trv_int * a + sums[k];
      const double change = (2 * config_.t_trv_int + config_.t_switch) * a + sums[d];
      // A box without extent has no scale, so it cannot anchor (the artifact aborts there).
      const bool opens = change < stay && arith::aqb8_can_anchor(r.box, config_.precision);
      choice_[offset_[v] + k] = opens;
      rows_[d - 1][k] += opens ? change : stay;
    }
  }

  const WideBvh& bvh_;
  const ClusterConfig& config_;
  std::vector<std::uint64_t> offset_;  // of a record's choices, one bit per proper ancestor
  std::vector<bool> choice_;
  std::vector<std::vector<double>> rows_;
  std::vector<Reference> path_;
  double root_area_ = 0;
};

// Emission, breadth first (build_int_bvh): assigns every record to a cluster.
class Emission {
 public:
  Emission(const WideBvh& bvh, const ClusterConfig& config, const Program& program)
      : bvh_(bvh), config_(config), program_(program), anchor_depth_(bvh.records.size(), 0) {}

  Clustering run() {
    const std::size_t n = bvh_.records.size();
    result_.cluster.assign(n, 0);
    result_.is_switch.assign(n, 0);
    parent_cluster_.assign(n, 0);
    std::vector<std::uint32_t> depth(n, 0);
    for (std::uint32_t i = 0; i < n; ++i) {
      const BvhRecord& r = bvh_.records[i];
      if (r.leaf()) {
        result_.cluster[i] = parent_cluster_[i];
        continue;
      }
      const bool opens = i == 0 || must_switch(i);
      result_.is_switch[i] = opens ? 1 : 0;
      result_.cluster[i] = opens ? open(i) : parent_cluster_[i];
      Cluster& own = result_.clusters[result_.cluster[i]];
      for (std::uint32_t c = r.first; c < r.first + r.count; ++c) {
        parent_cluster_[c] = result_.cluster[i];
        depth[c] = depth[i] + 1;
        anchor_depth_[c] = opens ? depth[i] : anchor_depth_[i];
        own.triangle_count += bvh_.records[c].leaf() ? bvh_.records[c].count : 0U;
      }
      own.node_count += r.count;
    }
    place();
    return std::move(result_);
  }

 private:
  bool must_switch(std::uint32_t i) {
    if (program_.switches(i, anchor_depth_[i])) {
      return true;
    }
    const Cluster& outer = result_.clusters[parent_cluster_[i]];
    const BvhRecord& r = bvh_.records[i];
    std::uint32_t triangles = 0;
    for (std::uint32_t c = r.first; c < r.first + r.count; ++c) {
      triangles += bvh_.records[c].leaf() ? bvh_.records[c].count : 0U;
    }
    const bool full = outer.node_count > config_.capacity - r.count ||
                      outer.triangle_count > config_.capacity - triangles;
    result_.capacity_splits += full ? 1U : 0U;
    return full;
  }

  std::uint32_t open(std::uint32_t anchor) {
    if (result_.clusters.size() >= config_.most_clusters) {
      throw UserError("AQB8 needs more than " + std::to_string(config_.most_clusters) +
                      " clusters, the most its child word can name; raise t_switch, or use the "
                      "16-byte nodes (node_bytes = 16), whose words are wider");
    }
    result_.clusters.push_back({anchor, 0, 0, 0, 0});
    return static_cast<std::uint32_t>(result_.clusters.size() - 1);
  }

  void place() {
    std::uint32_t nodes = 0, triangles = 0;
    std::vector<std::uint32_t> node_cursor, triangle_cursor;
    for (Cluster& c : result_.clusters) {
      c.node_offset = nodes;
      c.triangle_offset = triangles;
      node_cursor.push_back(nodes);
      triangle_cursor.push_back(triangles);
      nodes += c.node_count;
      triangles += c.triangle_count;
    }
    const std::size_t n = bvh_.records.size();
    result_.order.assign(nodes, 0);
    result_.position.assign(n, kNone);
    result_.first_primitive.assign(n, kNone);
    result_.primitives.assign(triangles, 0);
    for (std::uint32_t i = 1; i < n; ++i) {
      const std::uint32_t cluster = parent_cluster_[i];
      result_.position[i] = node_cursor[cluster]++;
      result_.order[result_.position[i]] = i;
      const BvhRecord& r = bvh_.records[i];
      if (r.leaf()) {
        result_.first_primitive[i] = triangle_cursor[cluster];
        for (std::uint32_t p = 0; p < r.count; ++p) {
          result_.primitives[triangle_cursor[cluster]++] = r.first + p;
        }
      }
    }
  }

  const WideBvh& bvh_;
  const ClusterConfig& config_;
  const Program& program_;
  std::vector<std::uint32_t> anchor_depth_;    // depth of the anchor a record is quantized against
  std::vector<std::uint32_t> parent_cluster_;  // cluster a record is stored in
  Clustering result_;
};

}  // namespace

double quantized_half_area(const Box& box, const Box& anchor) {
  return area(box, reference(anchor, arith::Aqb8Precision{}.levels()));
}

void adopt_cluster_order(WideBvh& bvh, Clustering& clusters) {
  std::vector<std::uint32_t> order;
  order.reserve(bvh.order.size());
  for (std::uint32_t& slot : clusters.primitives) {
    order.push_back(bvh.order[slot]);
    slot = static_cast<std::uint32_t>(order.size() - 1);
  }
  for (std::size_t i = 0; i < clusters.first_primitive.size(); ++i) {
    if (bvh.records[i].leaf()) {
      bvh.records[i].first = clusters.first_primitive[i];
    }
  }
  if (!clusters.primitives.empty()) {
    bvh.order = std::move(order);
  }
}

Clustering cluster_aqb8(const WideBvh& bvh, const ClusterConfig& config) {
  if (bvh.empty() || bvh.records[0].leaf()) {
    return {};  // nothing to cluster: the leaf is tested without a node
  }
  Program program(bvh, config);
  program.run();
  Clustering result = Emission(bvh, config, program).run();
  result.cost = program.cost();
  return result;
}

}  // namespace a2rt::bvh
