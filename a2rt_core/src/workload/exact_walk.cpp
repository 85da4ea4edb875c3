#include "a2rt/workload/exact_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "a2rt/workload/driver_triangle.h"
#include "a2rt/workload/ray_rules.h"
#include "driver_tree.h"

namespace a2rt {
namespace {

using driver::NodeType;
using driver::TreeView;

constexpr std::uint32_t kAccept = 0, kIgnore = 1, kTerminate = 2;  // capture::AnyHitVerdict

// The driver's min and max: the other operand if one is NaN.
float min_of(float a, float b) { return std::isnan(b) ? a : (a < b ? a : b); }
float max_of(float a, float b) { return std::isnan(b) ? a : (a > b ? a : b); }

// An object-space ray as the box test wants it.
struct BoxRay {
  Vec3 origin, inverse;
  BoxRay(const Vec3& o, const Vec3& dir) : origin(o) {
    for (std::size_t a = 0; a < 3; ++a) {
      inverse[a] = dir[a] == 0 ? std::numeric_limits<float>::max() : 1.0f / dir[a];
    }
  }
};

// Distance at which the ray enters the box, or NaN if it misses it or `tmax` lies before.
float enter(const Box& box, const BoxRay& ray, float tmax) {
  Vec3 near, far;
  for (std::size_t a = 0; a < 3; ++a) {
    const float t0 = (box.lo[a] - ray.origin[a]) * ray.inverse[a];
    const float t1 = (box.hi[a] - ray.origin[a]) * ray.inverse[a];
    near[a] = min_of(t0, t1);
    far[a] = max_of(t0, t1);
  }
  const float first = max_of(max_of(near.x, near.y), near.z);
  const float last = min_of(min_of(far.x, far.y), far.z);
  const bool active = !std::isnan(box.lo.x);
  const bool met = active && last >= max_of(0.0f, first) && first < tmax;
  return met ? first : std::numeric_limits<float>::quiet_NaN();
}

// One walk: the state the driver keeps per ray.
class Walk {
 public:
  Walk(const Workload& workload, const Ray& ray, std::span<const Candidate> candidates,
       bool keep_met)
      : workload_(workload),
        ray_(ray),
        candidates_(candidates),
        keep_met_(keep_met),
        tlas_(workload.tlas[ray.tlas].driver_nodes),
        nodes_(tlas_),
        box_ray_(ray.origin, ray.dir),
        triangle_test_(ray.origin, ray.dir),
        tmax_(ray.tmax) {}

  WalkResult run() {
    std::uint32_t node = driver::kRoot;
    while (!done_) {
      if (node == driver::kInvalidNode) {
        if (depth_ == 0) {
          break;
        }
        if (stack_base_ >= static_cast<int>(depth_)) {
          leave_instance();
        }
        node = stack_[--depth_];
      }
      node = visit(node);
    }
    result_.unused_verdicts = static_cast<std::uint32_t>(candidates_.size() - next_);
    return std::move(result_);
  }

 private:
  // Returns the node to visit next, or kInvalidNode to pop one.
  std::uint32_t visit(std::uint32_t node) {
    const std::uint32_t offset = node & ~3u;
    switch (static_cast<NodeType>(node & 3u)) {
      case NodeType::kBox:
        return box(nodes_.read<driver::BoxNode>(offset));
      case NodeType::kInstance:
        return instance(nodes_.read<driver::InstanceLeaf>(offset));
      case NodeType::kTriangle:
        triangle(nodes_.read<driver::TriangleLeaf>(offset));
        return driver::kInvalidNode;
      default:
        aabb(nodes_.read<driver::AabbLeaf>(offset));
        return driver::kInvalidNode;
    }
  }

  std::uint32_t box(const driver::BoxNode& node) {
    ++result_.box_tests;
    std::uint32_t first = driver::kInvalidNode, second = driver::kInvalidNode;
    const float t0 = enter(node.bounds[0], box_ray_, tmax_);
    const float t1 = enter(node.bounds[1], box_ray_, tmax_);
    const float inf = std::numeric_limits<float>::infinity();
    if (!std::isnan(t0)) {
      first = node.children[0];
    }
    if (!std::isnan(t1)) {
      second = node.children[1];
    }
    if ((std::isnan(t1) ? inf : t1) < (std::isnan(t0) ? inf : t0)) {
      std::swap(first, second);
    }
    if (second != driver::kInvalidNode) {
      push(second);
    }
    return first;
  }

  void push(std::uint32_t node) {
    if (depth_ == stack_.size()) {
      result_.stack_overflow = done_ = true;
      return;
    }
    stack_[depth_++] = node;
    result_.deepest_stack = std::max(result_.deepest_stack, depth_);
  }

  std::uint32_t instance(const driver::InstanceLeaf& leaf) {
    if (masked_out(leaf.custom_index_and_mask >> 24, ray_.mask)) {
      return driver::kInvalidNode;
    }
    instance_ = leaf.instance;
    flags_ = driver::decode_instance_flags(leaf.sbt_offset_and_flags);
    const std::uint32_t blas = workload_.tlas[ray_.tlas].instances[instance_].blas;
    if (blas == kNone || workload_.blas[blas].primitive_count() == 0) {
      return driver::kInvalidNode;
    }
    nodes_ = TreeView(workload_.blas[blas].driver_nodes);
    stack_base_ = static_cast<int>(depth_);
    enter_space(driver_transform_point(leaf.world_to_object, ray_.origin),
                driver_transform_direction(leaf.world_to_object, ray_.dir));
    return driver::kRoot;
  }
  void leave_instance() {
    stack_base_ = -1;
    nodes_ = tlas_;
    enter_space(ray_.origin, ray_.dir);
  }
  void enter_space(const Vec3& origin, const Vec3& dir) {
    box_ray_ = BoxRay(origin, dir);
    triangle_test_ = DriverTriangleTest(origin, dir);
  }

  void triangle(const driver::TriangleLeaf& leaf) {
    ++result_.triangle_tests;
    const DriverTriangleHit found = triangle_test_(leaf.triangle);
    if (!found.hit || !triangle_in_range(found.t, ray_.tmin, tmax_) ||
        (ray_.flags & kRaySkipTriangles) != 0) {
      return;
    }
    const bool front = faces_front(found.front, flags_);
    const bool opaque = leaf_opaque(leaf.geometry_and_flags);
    if (culled_by_facing(front, flags_, ray_.flags) || culled_by_opacity(opaque, ray_.flags)) {
      return;
    }
    Hit hit{HitState::kHit, found.t,
            instance_,      leaf.geometry_and_flags & driver::kGeometryIndexMask,
            leaf.primitive, front ? kHitKindFront : kHitKindBack};
    const std::uint32_t verdict = opaque ? kAccept : judge(hit);
    if (verdict != kIgnore) {
      commit(hit, verdict);
    }
  }

  bool leaf_opaque(std::uint32_t geometry_and_flags) const {
    return is_opaque((geometry_and_flags & driver::kGeometryOpaque) != 0, flags_, ray_.flags);
  }

  // What the any-hit shader said, or what happens without one.
  std::uint32_t judge(const Hit& hit) {
    std::uint32_t verdict = (ray_.flags & kRayQuery) != 0 ? kIgnore : kAccept;
    if (next_is(hit.instance, hit.geometry, hit.primitive, 0) && candidates_[next_].t == hit.t) {
      verdict = candidates_[next_++].verdict;
    }
    note({hit.instance, hit.geometry, hit.primitive, hit.t, hit.kind, verdict, 0});
    return verdict;
  }

  // Repeats what the intersection shader reported for this box.
  void aabb(const driver::AabbLeaf& leaf) {
    const std::uint32_t geometry = leaf.geometry_and_flags & driver::kGeometryIndexMask;
    if (culled_by_opacity(leaf_opaque(leaf.geometry_and_flags), ray_.flags) ||
        (ray_.flags & kRaySkipAabbs) != 0) {
      return;
    }
    while (next_is(instance_, geometry, leaf.primitive, 1)) {
      const Candidate report = candidates_[next_++];
      note(report);
      // Once the ray is terminated, what the same shader still reports is refused.
      const bool in_range = !done_ && report_in_range(report.t, ray_.tmin, tmax_);
      std::uint32_t verdict = kAccept;
      if (in_range && next_is(instance_, geometry, leaf.primitive, 0)) {
        verdict = candidates_[next_].verdict;
        note(candidates_[next_++]);
      }
      const bool accepted = in_range && verdict != kIgnore;
      if (accepted) {
        commit({HitState::kHit, report.t, instance_, geometry, leaf.primitive, report.kind},
               verdict);
      }
      result_.disagreements += accepted != (report.verdict != 0) ? 1 : 0;
    }
  }

  bool next_is(std::uint32_t instance, std::uint32_t geometry, std::uint32_t primitive,
               std::uint32_t is_report) const {
    if (next_ == candidates_.size()) {
      return false;
    }
    const Candidate& c = candidates_[next_];
    return c.is_report == is_report && c.primitive == primitive && c.instance == instance &&
           c.geometry == geometry;
  }
  void note(const Candidate& candidate) {
    if (keep_met_) {
      result_.met.push_back(candidate);
    }
  }
  void commit(const Hit& hit, std::uint32_t verdict) {
    tmax_ = hit.t;
    result_.hit = hit;
    done_ = verdict == kTerminate || (ray_.flags & kRayTerminateOnFirstHit) != 0;
  }

  const Workload& workload_;
  const Ray& ray_;
  std::span<const Candidate> candidates_;
  bool keep_met_;
  TreeView tlas_, nodes_;
  BoxRay box_ray_;
  DriverTriangleTest triangle_test_;
  float tmax_;
  std::array<std::uint32_t, driver::kStackEntries> stack_;
  std::uint32_t depth_ = 0;
  int stack_base_ = -1;
  std::uint32_t instance_ = kNone, flags_ = 0;
  std::size_t next_ = 0;
  bool done_ = false;
  WalkResult result_;
};

std::string tlas_problem(const Workload& workload, std::uint32_t index,
                         const std::vector<std::string>& blas_problems) {
  const Tlas& tlas = workload.tlas[index];
  if (tlas.instances.empty()) {
    return "";
  }
  if (tlas.driver_nodes.empty()) {
    return "tlas " + std::to_string(index) + ": the driver's nodes were not captured";
  }
  const std::string problem = driver::check_tlas(tlas.driver_nodes, tlas);
  if (!problem.empty()) {
    return "tlas " + std::to_string(index) + ": " + problem;
  }
  for (const Instance& instance : tlas.instances) {
    if (instance.blas != kNone && !blas_problems[instance.blas].empty()) {
      return "blas " + std::to_string(instance.blas) + ": " + blas_problems[instance.blas];
    }
  }
  return "";
}

}  // namespace

ExactWalk::ExactWalk(const Workload& workload) : workload_(workload) {
  std::vector<std::string> blas_problems;
  for (const Blas& blas : workload.blas) {
    const bool needed = blas.primitive_count() > 0;
    blas_problems.push_back(!needed ? ""
                            : blas.driver_nodes.empty()
                                ? "the driver's nodes were not captured"
                                : driver::check_blas(blas.driver_nodes, blas));
  }
  for (std::uint32_t i = 0; i < workload.tlas.size(); ++i) {
    problems_.push_back(tlas_problem(workload, i, blas_problems));
  }
}

WalkResult ExactWalk::walk(const Ray& ray, std::span<const Candidate> candidates,
                           bool keep_met) const {
  if (workload_.tlas[ray.tlas].instances.empty()) {
    return {};
  }
  return Walk(workload_, ray, candidates, keep_met).run();
}

}  // namespace a2rt
