// The A2RT unit (see traversal.h for the parts of a Unit).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "a2rt/arith/qbox.h"
#include "a2rt/arith/ray_quantizer.h"
#include "a2rt/arith/slab.h"
#include "a2rt/bvh/address_space.h"
#include "a2rt/bvh/classify.h"
#include "a2rt/bvh/layout_a2rt.h"
#include "a2rt/rt/a2rt_tree.h"
#include "a2rt/rt/event.h"
#include "a2rt/rt/settings.h"
#include "a2rt/rt/sinks.h"
#include "a2rt/rt/unit.h"

namespace a2rt::rt {

class A2rtUnit {
 public:
  using Tree = A2rtTree;
  using Key = float;  // lower bound of the entry distance, for groups and sub nodes alike
  static constexpr bool kContexts = true;
  struct Context {
    arith::GroupRay ray;
    std::uint32_t group = 0;  // the node that opened it
    bool escaped = false;
    float limit = 0,
          left = 0;  // `left` is what remains of the ray while the closest hit is `limit`
  };
  struct ContextRecord {
    Traffic traffic;
    Address address;
    std::uint64_t bytes;
  };
  struct Space {
    Space(const A2rtUnit&, const Vec3& origin, const Vec3& dir, float tmin, const Tree& tree)
        : slab(arith::make_slab_ray(origin, dir, tmin, tree.largest_coordinate())),
          quantizer(arith::make_quantizer_ray(origin, dir)) {}
    arith::SlabRay slab;
    arith::QuantizerRay quantizer;
  };

  // `origin`: default of the knob precision.origin.
  A2rtUnit(const config::Section& section, const std::string& name, const std::string& title,
           arith::OriginDesign origin);

  const UnitSettings& settings() const { return settings_; }
  const UnitInfo& info() const { return info_; }
  const arith::A2rtPrecision& precision() const { return quantizer_.precision(); }

  A2rtTree encode(bvh::WideBvh& tree, const std::string& name, bvh::AddressSpace& space,
                  StructureStats& stats) const;

  // The root's own box is tested like any group's.
  template <class Sink>
  bool open_root(const Tree& tree, const Space& space, Context& context, float closest,
                 Sink& sink) const {
    sink.fetch(Traffic::kGroupNode, tree.base(), group_bytes_);
    sink.count(EventKind::kBoxTest, 1);
    const arith::SlabHit entry = test_group(space.slab, tree.root_box(), closest);
    if constexpr (Sink::kAudits) {
      const bvh::BvhRecord root{tree.root_box()};
      sink.decide_fp32({&root, 1}, 1, entry.hit ? 1 : 0, closest, group_mechanism());
    }
    if (entry.hit) {
      enter(tree, space, context, tree.root().index(), entry.t_entry, sink);
    }
    return entry.hit;
  }

  // `key`: the group's entry, from the accurate test of its box. A group that waited on the stack
  // has left the unit's registers, so its record is read again.
  template <class Sink>
  bool open(const Tree& tree, std::uint32_t index, const Space& space, Context& context, Key key,
            bool fresh, float, Sink& sink) const {
    if constexpr (Sink::kEmits) {
      if (!fresh && refetch_group_) {
        sink.fetch(Traffic::kGroupNode, tree.base() + Bytes{tree.node(index).record_offset},
                   group_bytes_);
      }
    }
    enter(tree, space, context, index, key, sink);
    return true;
  }

  template <class Sink>
  std::uint32_t test(const Tree& tree, std::uint32_t index, const Space& space, Context& context,
                     float closest, Key* keys, Sink& sink) const {
    const A2rtNode& node = tree.node(index);
    if constexpr (Sink::kEmits || Sink::kAudits) {
      emit_visit(tree, node, context, sink);
    }
    const std::uint32_t all = (1U << node.count) - 1;
    const std::uint32_t groups = (1U << node.group_count) - 1;
    std::uint32_t hit = 0;
    if (groups != all) {
      hit = context.escaped ? test_escaped(tree, node, all & ~groups, space, context, closest, keys)
                            : test_quantized(tree, node, all & ~groups, context, closest, keys);
    }
    if (groups != 0) {
      float entry[bvh::kMaxWidth];
      hit |= groups & (literal_ ? test_groups_plain(tree.group_boxes(node), space, closest, entry)
                                : arith::slab_test_block(space.slab, tree.group_boxes(node),
                                                         closest, entry));
      std::copy_n(entry, node.group_count, keys);
    }
    if constexpr (Sink::kAudits) {
      sink.decide(tree.exact_children(index), all & ~groups, hit, closest,
                  [this](std::size_t) { return miss_mechanism(); });
      sink.decide_fp32(tree.exact_children(index), groups, hit, closest, group_mechanism());
    }
    return hit;
  }

  template <class Sink>
  bool culled(const Tree&, const Space&, Key key, Context&, float closest, Sink&) const {
    return key > closest;
  }

  ContextRecord context_record(const Tree& tree, const Context& context) const {
    return {Traffic::kGroupNode, tree.base() + Bytes{tree.node(context.group).record_offset},
            group_bytes_};
  }

 private:
  template <class Sink>
  void enter(const Tree& tree, const Space& space, Context& context, std::uint32_t group,
             float t_entry, Sink& sink) const {
    sink.count(EventKind::kQuantizeRay, 1);
    context.group = group;
    context.escaped = quantizer_.enter(space.quantizer, tree.frame(group), t_entry, context.ray) ==
                      arith::GroupEntry::kEscaped;
    context.ray.t_shift = t_entry;
    context.limit = std::numeric_limits<float>::quiet_NaN();  // equals no closest hit
  }

  template <class Sink>
  void emit_visit(const Tree& tree, const A2rtNode& node, const Context& context,
                  Sink& sink) const {
    const Address at = tree.base() + Bytes{node.fetch_offset};
    const std::uint64_t group_bytes = std::uint64_t{node.group_count} * group_bytes_;
    const std::uint32_t subs = std::uint32_t{node.count} - node.group_count;
    // One read of adjacent bytes, told apart by kind; then all tests.
    if (node.group_count > 0) {
      sink.fetch(Traffic::kGroupNode, at, group_bytes);
    }
    if (subs > 0) {
      sink.fetch(Traffic::kSubNode, at + Bytes{group_bytes}, std::uint64_t{subs} * sub_bytes_);
    }
    if (context.escaped && subs > 0) {
      sink.count(EventKind::kEscape, subs);
      sink.count(EventKind::kDequantize, subs);
      sink.count(EventKind::kBoxTest, node.count);
      return;
    }
    if (node.group_count > 0) {
      sink.count(EventKind::kBoxTest, node.group_count);
    }
    if (subs > 0) {
      sink.count(EventKind::kQBoxTest, subs);
    }
  }

  // Sub nodes in the quantized tester; `subs` masks them. Fills the keys of all slots.
  std::uint32_t test_quantized(const Tree& tree, const A2rtNode& node, std::uint32_t subs,
                               Context& context, float closest, Key* keys) const {
    const float shift = context.ray.t_shift;
    // Only without re-test on pop: the frame itself lies beyond the closest hit.
    if (shift > closest) {
      return 0;
    }
    if (context.limit != closest) {
      context.limit = closest;
      context.left = quantizer_.remaining(closest, shift);
    }
    float near[bvh::kMaxWidth];
    const std::uint32_t hit =
        subs & tester_.test(context.ray, tree.planes(node), context.left, near);
    // Lower bound of shift + near in real numbers: the sum errs by half a unit in the last place.
    const auto key = [shift](float t) {
      const float sum = shift + t;
      return sum - std::fabs(sum) * 0x1p-23F;
    };
    for (std::size_t s = 0; s < bvh::kMaxWidth; ++s) {  // all at once; misses are not looked at
      keys[s] = key(near[s]);
    }
    return hit;
  }

  // The paper's accurate unit is plain FP32; only the conservative designs pad it.
  arith::SlabHit test_group(const arith::SlabRay& ray, const Box& box, float closest) const {
    return literal_ ? arith::slab_test_plain(ray, box, closest)
                    : arith::slab_test(ray, box, closest);
  }
  std::uint32_t test_groups_plain(const arith::BoxBlock& boxes, const Space& space, float closest,
                                  float* entry) const;

  // The accurate units on boxes rebuilt in FP32: what an escaped pair costs and gets.
  std::uint32_t test_escaped(const Tree& tree, const A2rtNode& node, std::uint32_t subs,
                             const Space& space, const Context& context, float closest,
                             Key* keys) const;
  std::string miss_mechanism() const;
  const char* group_mechanism() const {
    return literal_ ? "group test: unpadded FP32" : "broken guarantee of the FP32 test";
  }

  UnitInfo info_;
  UnitSettings settings_;
  bvh::ClassifyConfig classify_;
  arith::RayQuantizer quantizer_;
  arith::QBoxTester tester_;
  std::uint32_t group_bytes_, sub_bytes_;
  bool refetch_group_;
  bool literal_;
};

}  // namespace a2rt::rt
