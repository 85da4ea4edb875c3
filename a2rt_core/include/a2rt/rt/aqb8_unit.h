// The AQB8 unit (see traversal.h for the parts of a Unit): integer boxes per cluster, 5-bit shifts,
// and all the ways in which they lose hits.
#pragma once

#include <cstdint>
#include <string>

#include "a2rt/arith/aqb8_arith.h"
#include "a2rt/rt/aqb8_tree.h"
#include "a2rt/rt/event.h"
#include "a2rt/rt/settings.h"
#include "a2rt/rt/sinks.h"
#include "a2rt/rt/traversal.h"
#include "a2rt/rt/unit.h"

namespace a2rt::rt {

class Aqb8Unit {
 public:
  using Tree = Aqb8Tree;
  using Key = std::int32_t;  // entry in the cluster's integer units
  static constexpr bool kContexts = true;
  struct Context {
    arith::Aqb8Local local;
    std::uint32_t cluster = 0;
    float limit = 0;  // closest hit that local.qy_max stands for
  };
  struct ContextRecord {
    Traffic traffic;
    Address address;
    std::uint64_t bytes;
  };
  // The artifact divides the direction by its FP32 length first; t scales with it.
  struct Space {
    Space(const Aqb8Unit& unit, const Vec3& origin, const Vec3& dir, float tmin, const Tree&);
    float scaled(float t) const { return t * length; }
    arith::Aqb8Ray ray;
    float length = 1;
  };

  explicit Aqb8Unit(const config::Section& section);

  const UnitSettings& settings() const { return settings_; }
  const UnitInfo& info() const { return info_; }
  const arith::Aqb8Precision& precision() const { return clusters_.precision; }

  Aqb8Tree encode(bvh::WideBvh& tree, const std::string& name, bvh::AddressSpace& space,
                  StructureStats& stats) const;

  template <class Sink>
  bool open_root(const Tree& tree, const Space& space, Context& context, float closest,
                 Sink& sink) const {
    return open_cluster(tree, space, context, 0, closest, sink);
  }

  template <class Sink>
  bool open(const Tree& tree, std::uint32_t index, const Space& space, Context& context, Key, bool,
            float closest, Sink& sink) const {
    return open_cluster(tree, space, context, tree.node(index).cluster, closest, sink);
  }

  template <class Sink>
  std::uint32_t test(const Tree& tree, std::uint32_t index, const Space& space, Context& context,
                     float closest, Key* keys, Sink& sink) const {
    const Aqb8Node& node = tree.node(index);
    const std::uint32_t slots = artifact_ ? window(tree, node) : node.count;
    refresh(tree, space, context, closest, sink);
    if constexpr (Sink::kEmits || Sink::kAudits) {
      emit_visit(tree, node, slots, sink);
    }
    static_assert(bvh::kMaxWidth == arith::Aqb8Block::kWidth);
    const std::uint32_t hit =
        arith::aqb8_test_block(space.ray, context.local, node.boxes, keys) & ((1U << slots) - 1);
    if constexpr (Sink::kAudits) {
      sink.decide(tree.exact_children(index), (1U << node.count) - 1, hit, closest,
                  [&](std::size_t) { return miss_mechanism(space, context); });
    }
    return hit;
  }

  template <class Sink>
  bool culled(const Tree& tree, const Space& space, Key key, Context& context, float closest,
              Sink& sink) const {
    refresh(tree, space, context, closest, sink);
    return key > context.local.qy_max;
  }

  ContextRecord context_record(const Tree& tree, const Context& context) const {
    return {Traffic::kAnchor, anchor_address(tree, context.cluster), anchor_bytes_};
  }

 private:
  friend struct Space;

  template <class Sink>
  bool open_cluster(const Tree& tree, const Space& space, Context& context, std::uint32_t cluster,
                    float closest, Sink& sink) const {
    const arith::Aqb8Anchor& anchor = tree.anchor(cluster);
    if constexpr (Sink::kEmits) {
      if (by_lines()) {
        fetch_lines(sink, settings_.layout.accounting, Traffic::kAnchor,
                    anchor_address(tree, cluster), anchor_bytes_);
      } else {
        sink.fetch(Traffic::kAnchor, anchor_address(tree, cluster), anchor_bytes_);
      }
    }
    sink.count(EventKind::kAnchorTest, 1);
    const float limit = space.scaled(closest);
    const arith::Aqb8Entry entry = arith::aqb8_anchor_test(space.ray, anchor, limit);
    if (!entry.hit) {
      if constexpr (Sink::kAudits) {
        sink.decide({&tree.anchor_record(cluster), 1}, 1, 0, closest,
                    [](std::size_t) { return "anchor test: unpadded FP32"; });
      }
      return false;
    }
    context.cluster = cluster;
    context.limit = closest;
    context.local = arith::aqb8_enter(space.ray, anchor, entry.y_ref, limit, rounding_);
    return true;
  }

  // UPDT: the closest hit changed since the cluster's integers were made.
  template <class Sink>
  void refresh(const Tree& tree, const Space& space, Context& context, float closest,
               Sink& sink) const {
    if (context.limit == closest) {
      return;
    }
    sink.count(EventKind::kUpdate, 1);
    context.local.qy_max = arith::aqb8_qy_max(tree.anchor(context.cluster), context.local.y_ref,
                                              space.scaled(closest), rounding_);
    context.limit = closest;
  }

  template <class Sink>
  void emit_visit(const Tree& tree, const Aqb8Node& node, std::uint32_t slots, Sink& sink) const {
    if (by_lines()) {
      // The public code forgets node_offset: every cluster's nodes lie on the first one's.
      const bool aliased = settings_.layout.accounting == Accounting::kPublished;
      const std::uint32_t at = node.first - (aliased ? tree.cluster(node.cluster).node_offset : 0U);
      fetch_lines(sink, settings_.layout.accounting, Traffic::kSubNode,
                  tree.node_base() + Bytes{std::uint64_t{at} * node_bytes_}, node_bytes_);
    } else {
      sink.fetch(Traffic::kSubNode,
                 tree.node_base() + Bytes{std::uint64_t{node.first} * node_bytes_},
                 std::uint64_t{node.count} * node_bytes_);
    }
    sink.count(EventKind::kQBoxTest, slots);
  }

  // Slots the artifact tests: six, as long as the cluster lasts, related or not.
  std::uint32_t window(const Tree& tree, const Aqb8Node& node) const {
    const bvh::Cluster& c = tree.cluster(node.cluster);
    return std::min(settings_.tree.branching, c.node_offset + c.node_count - node.first);
  }

  bool by_lines() const { return settings_.layout.accounting != Accounting::kRecords; }

  Address anchor_address(const Tree& tree, std::uint32_t cluster) const {
    return tree.anchor_base() + Bytes{std::uint64_t{cluster} * anchor_bytes_};
  }
  std::string miss_mechanism(const Space& space, const Context& context) const;

  static constexpr std::uint32_t kArtifactNodeBytes = 48, kArtifactAnchorBytes = 40;

  UnitInfo info_;
  UnitSettings settings_;
  bvh::ClusterConfig clusters_;
  arith::Aqb8Rounding rounding_ = arith::Aqb8Rounding::kFloorCeil;
  std::uint32_t node_bytes_ = 16, anchor_bytes_ = bvh::kAqb8AnchorBytes;
  bool artifact_ = false, normalize_ = true;
};

}  // namespace a2rt::rt
