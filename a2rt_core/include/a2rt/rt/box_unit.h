// What the units that test FP32 boxes share (see traversal.h for the parts of a Unit).
#pragma once

#include <cstdint>
#include <string>

#include "a2rt/arith/slab.h"
#include "a2rt/rt/accounting.h"
#include "a2rt/rt/box_tree.h"
#include "a2rt/rt/event.h"
#include "a2rt/rt/settings.h"
#include "a2rt/rt/sinks.h"
#include "a2rt/rt/unit.h"

namespace a2rt::rt {

class BoxUnit {
 public:
  using Tree = BoxTree;
  using Key = float;  // lower bound of the entry distance
  static constexpr bool kContexts = false;
  struct Context {};
  struct Space {
    Space(const BoxUnit&, const Vec3& origin, const Vec3& dir, float tmin, const Tree& tree)
        : slab(arith::make_slab_ray(origin, dir, tmin, tree.largest_coordinate())) {}
    arith::SlabRay slab;
  };

  const UnitSettings& settings() const { return settings_; }
  const UnitInfo& info() const { return info_; }

  template <class Sink>
  bool open_root(const Tree&, const Space&, Context&, float, Sink&) const {
    return true;
  }

  template <class Sink>
  std::uint32_t test(const Tree& tree, std::uint32_t index, const Space& space, Context&,
                     float closest, Key* keys, Sink& sink) const {
    const BoxNode& node = tree.node(index);
    if constexpr (Sink::kEmits || Sink::kAudits) {
      const Address at = tree.base() + Bytes{node.fetch_offset};
      if (settings_.layout.accounting == Accounting::kRecords) {
        sink.fetch(Traffic::kNode, at, node.fetch_bytes);
      } else {
        fetch_wide_node(sink, settings_.layout.accounting, at);
      }
      if (node.dequantized) {
        sink.count(EventKind::kDequantize, node.count);
      }
      sink.count(EventKind::kBoxTest, node.count);
    }
    const std::uint32_t all = (1U << node.count) - 1;
    const std::uint32_t hit = arith::slab_test_block(space.slab, node.boxes, closest, keys) & all;
    if constexpr (Sink::kAudits) {
      sink.decide(tree.exact_children(index), node.dequantized ? all : 0, hit, closest,
                  [](std::size_t) { return "FP32 test of a dequantized box"; });
      sink.decide_fp32(tree.exact_children(index), node.dequantized ? 0 : all, hit, closest,
                       "broken guarantee of the FP32 test");
    }
    return hit;
  }

  template <class Sink>
  bool culled(const Tree&, const Space&, Key key, Context&, float closest, Sink&) const {
    return key > closest;
  }

 protected:
  BoxUnit(UnitInfo info, UnitSettings settings) : info_(std::move(info)), settings_(settings) {}

  UnitInfo info_;
  UnitSettings settings_;
};

}  // namespace a2rt::rt
