// RtUnit on top of the engine: builds the trees of a workload, lets the unit encode them, and runs
// the traversal with the three sinks.
//
// A Unit (see traversal.h) also has
//   settings(), info()
//   Tree encode(bvh::WideBvh&, const std::string& name, bvh::AddressSpace&, StructureStats&) const
// encode() takes the tree's records and may reorder WideBvh::order, which it must leave.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "a2rt/base/thread_clock.h"
#include "a2rt/bvh/instance_boxes.h"
#include "a2rt/rt/traversal.h"
#include "a2rt/rt/unit.h"
#include "a2rt/workload/parts.h"

namespace a2rt::rt {

// Adds what does not depend on the encoding.
inline void add_tree_stats(const bvh::WideBvh& tree, StructureStats& stats) {
  stats.build_seconds += tree.build_seconds;
  stats.inner_nodes += tree.inner_count();
  stats.leaf_nodes += tree.leaf_count();
  stats.depth = std::max<std::uint64_t>(stats.depth, tree.depth);
  stats.sah_cost += bvh::sah_cost(tree);
}

template <class Unit>
class TreeUnit final : public RtUnit {
 public:
  explicit TreeUnit(Unit unit) : unit_(std::move(unit)) {}

  const UnitInfo& info() const override { return unit_.info(); }
  StructureStats structure() const override { return stats_; }

  std::vector<MemoryRegion> regions() const override {
    std::vector<MemoryRegion> all;
    for (const bvh::Region& r : regions_) {
      all.push_back({r.name, r.base, r.bytes});
    }
    return all;
  }

  void build(const Workload& workload) override {
    const UnitSettings& settings = unit_.settings();
    s_ = {};
    s_.traversal = settings.traversal;
    s_.layout = settings.layout;
    stats_ = {};
    bvh::AddressSpace space(Bytes{settings.layout.region_alignment});
    const bvh::WideBuilder builder(settings.tree);
    std::vector<Box> object_boxes;
    for (std::size_t b = 0; b < workload.blas.size(); ++b) {
      const Blas& blas = workload.blas[b];
      const std::string name = "BLAS " + std::to_string(b);
      bvh::WideBvh tree = blas.procedural()
                              ? builder.build(std::span<const Box>(blas.aabbs))
                              : builder.build(std::span<const Triangle>(blas.triangles));
      check_depth(tree, name);
      object_boxes.push_back(tree.empty() ? Box{} : tree.records[0].box);
      add_tree_stats(tree, stats_);
      s_.blas.push_back(unit_.encode(tree, name, space, stats_));
      s_.primitives.push_back(arrange_primitives(blas, tree, settings.layout, space, name));
      (blas.procedural() ? stats_.box_bytes : stats_.triangle_bytes) +=
          tree.order.size() * (blas.procedural() ? sizeof(Box) : sizeof(Triangle));
    }
    build_tops(workload, settings, object_boxes, space);
    s_.judges_candidates = judges_candidates(workload);
    if (settings.layout.accounting != Accounting::kRecords) {
      s_.first_ray = workload.rays.data();
      s_.ray_count = workload.rays.size();
      s_.results = space.reserve(
          "hit records", Bytes{std::max<std::size_t>(1, s_.ray_count) * kPublishedResultBytes});
    }
    regions_ = space.regions();
  }

  using RtUnit::trace;
  Hit trace(const RayInput& input) const override {
    NullSink sink;
    return Traversal<Unit, NullSink>(unit_, s_, input, sink).run();
  }
  Hit trace(const RayInput& input, EventReceiver& events) const override {
    EventSink sink(events);
    return Traversal<Unit, EventSink>(unit_, s_, input, sink).run();
  }
  Hit trace(const RayInput& input, Audit& audit) const override {
    AuditSink sink(audit);
    return Traversal<Unit, AuditSink>(unit_, s_, input, sink).run();
  }

  const Structures<Unit>& structures() const { return s_; }
  const Unit& unit() const { return unit_; }

 private:
  void build_tops(const Workload& workload, const UnitSettings& settings,
                  const std::vector<Box>& object_boxes, bvh::AddressSpace& space) {
    // One instance per leaf: entering an instance is the costliest step, so none is tried together
    // with another.
    const bvh::WideBuilder builder({settings.tree.branching, 1});
    for (std::uint32_t t = 0; t < workload.tlas.size(); ++t) {
      const bvh::RayReach reach = bvh::ray_reach(workload.rays, t);
      std::vector<Box> boxes;
      for (const Instance& instance : workload.tlas[t].instances) {
        if (instance.blas != kNone && instance.blas >= object_boxes.size()) {
          throw UserError("an instance of TLAS " + std::to_string(t) + " names BLAS " +
                          std::to_string(instance.blas) + ", but there are " +
                          std::to_string(object_boxes.size()) + "; the workload file is damaged");
        }
        boxes.push_back(bvh::instance_world_box(
            instance, instance.blas == kNone ? Box{} : object_boxes[instance.blas], reach));
      }
      const std::string name = "TLAS " + std::to_string(t);
      bvh::WideBvh tree = builder.build(std::span<const Box>(boxes));
      check_depth(tree, name);
      add_tree_stats(tree, stats_);
      s_.tlas.push_back(unit_.encode(tree, name, space, stats_));
      s_.tops.push_back(arrange_instances(workload.tlas[t], tree, settings.layout, space, name));
    }
  }

  static void check_depth(const bvh::WideBvh& tree, const std::string& name) {
    if (tree.depth > kMostDepth) {
      throw UserError(name + ": its tree is " + std::to_string(tree.depth) +
                      " levels deep, the units' stacks hold " + std::to_string(kMostDepth) +
                      "; raise tree.branching or tree.max_leaf");
    }
  }

  Unit unit_;
  Structures<Unit> s_;
  StructureStats stats_;
  std::vector<bvh::Region> regions_;
};

// Processor seconds of one step of a build.
template <class Step>
double seconds_of(const Step& step) {
  const double start = thread_seconds();
  step();
  return thread_seconds() - start;
}

}  // namespace a2rt::rt
