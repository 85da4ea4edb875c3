// The traversal engine: one for all units, a template on the unit and on the event sink.
//
// A Unit brings the encoding and the box tests:
//   Tree      one encoded structure: root() -> ChildRef, children(node) -> ChildRef[]
//   Space     per-ray constants in one structure's coordinates; Space(unit, origin, dir, tmin,
//   tree) Context   state of a frame (A2RT group, AQB8 cluster); units without frames set kContexts
//   false Key       what children are ordered by and popped entries re-tested with open()    starts
//   the frame of a node; false if the frame cannot be hit test()    fetches and tests a node's
//   children: hit mask and keys culled()  whether a popped entry lies beyond the closest hit
// The engine brings the order of visits, the stack, the frames' saving and restoring, leaves,
// instances, Vulkan's candidate rules and the closest hit.
//
// Ties: of several hits at one t the smallest (instance, geometry, primitive) wins, and boxes are
// culled only when strictly beyond the closest hit, so the order of slots does not show.
//
// Frames: entries of one frame form a run on the stack. A frame is set aside (kContextPush) when
// another opens while entries of it remain, and restored (kContextPop) when one of them is popped,
// or forgotten (kContextPop of count 0) when the last of them turns out to need no restoring.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <new>

#include "a2rt/arith/slab.h"
#include "a2rt/base/inline.h"
#include "a2rt/bvh/child_ref.h"
#include "a2rt/rt/accounting.h"
#include "a2rt/rt/candidates.h"
#include "a2rt/rt/fast_triangle.h"
#include "a2rt/rt/scene.h"
#include "a2rt/rt/sinks.h"
#include "a2rt/workload/driver_triangle.h"
#include "a2rt/workload/ray_rules.h"

namespace a2rt::rt {

// Deepest tree the engine's fixed stack takes: Embree stops at 32 levels plus 8 for large leaves.
inline constexpr unsigned kMostDepth = 48;
inline constexpr unsigned kStackEntries = kMostDepth * (bvh::kMaxWidth - 1) + 1;

template <class Unit>
struct Structures {
  std::vector<typename Unit::Tree> tlas, blas;
  std::vector<SceneTop> tops;          // per TLAS
  std::vector<Primitives> primitives;  // per BLAS
  TraversalSettings traversal;
  LayoutSettings layout;
  // Some shader or ray query of the program judges candidates; without one, a candidate is accepted
  // and never leaves the unit.
  bool judges_candidates = true;
  // Hit records, one per ray of the workload; only with Accounting::kPublished or kCorrected.
  const Ray* first_ray = nullptr;
  std::size_t ray_count = 0;
  Address results;
};

template <class Unit, class Sink>
class Traversal {
  using Tree = typename Unit::Tree;
  using Space = typename Unit::Space;
  using Context = typename Unit::Context;
  using Key = typename Unit::Key;
  using ChildRef = bvh::ChildRef;

 public:
  Traversal(const Unit& unit, const Structures<Unit>& structures, const RayInput& input, Sink& sink)
      : unit_(unit), s_(structures), ray_(*input.ray), candidates_(input.candidates), sink_(sink) {}

  Hit run() {
    if (ray_.tlas >= s_.tlas.size() || s_.tlas[ray_.tlas].empty() ||
        !arith::ray_is_active(ray_.origin, ray_.dir, ray_.tmin, ray_.tmax)) {
      return {};
    }
    closest_ = ray_.tmax;
    top_ = &s_.tops[ray_.tlas];
    const Tree& tree = s_.tlas[ray_.tlas];
    sink_.count(EventKind::kRaySetup, 1);
    if (tree.root().is_leaf()) {
      visit_instances(tree.root());
    } else {
      enter_space(ray_.origin, ray_.dir);
      walk<true>(tree, Space(unit_, ray_.origin, ray_.dir, ray_.tmin, tree),
                 [this](ChildRef leaf) { return visit_instances(leaf); });
      leave_space();
    }
    if (hit_.state == HitState::kHit) {
      hit_.t = closest_;
      if constexpr (Sink::kEmits) {
        fetch_hit();
      }
    }
    return hit_;
  }

 private:
  struct Entry {
    Key key;
    ChildRef ref;
    std::uint32_t context;
  };

  // Frames of one walk, made one by one: most walks open few.
  class ContextStack {
   public:
    Context& make(std::uint32_t i) { return *::new (raw_ + i * sizeof(Context)) Context; }
    Context& operator[](std::uint32_t i) {
      return *std::launder(reinterpret_cast<Context*>(raw_ + i * sizeof(Context)));
    }

   private:
    static constexpr std::size_t kMost = Unit::kContexts ? kMostDepth + 1 : 1;
    alignas(Context) std::byte raw_[kMost * sizeof(Context)];
  };

  // Visits a tree in the ray's order; `visit_leaf` returns true to end the whole traversal.
  template <bool kTop, class VisitLeaf>
  bool walk(const Tree& tree, const Space& space, const VisitLeaf& visit_leaf) {
    if (tree.root().is_leaf()) {
      return visit_leaf(tree.root());
    }
    Entry stack[kStackEntries];
    ContextStack contexts;
    std::uint64_t saved = 0;  // bit c: context c is set aside
    Entry* top = stack;
    std::uint32_t live = 0;  // context the unit holds
    if (!unit_.open_root(tree, space, contexts.make(0), closest_, sink_)) {
      return false;
    }
    Entry current{Key{}, tree.root(), 0};
    for (;;) {
      Key keys[bvh::kMaxWidth];
      std::uint32_t mask =
          unit_.test(tree, current.ref.index(), space, contexts[live], closest_, keys, sink_);
      Entry* const before = top;
      if (s_.traversal.leaves_at_once) {
        if (visit_hit_leaves(tree.children(current.ref.index()), mask, visit_leaf)) {
          return true;
        }
      }
      if (mask != 0) {
        top = push_hits(tree, tree.children(current.ref.index()), mask, keys, live, top);
      }
      bool fresh = top != before;  // the top entry was just tested: not a pop
      if (fresh && top - before > 1) {
        sink_.count(EventKind::kPush, static_cast<std::size_t>(top - before) - 1);
      }
      for (;; fresh = false) {
        if (top == stack) {
          return false;
        }
        current = *--top;
        if (!fresh) {
          sink_.count(EventKind::kPop, 1);
          if (s_.traversal.retest_on_pop &&
              unit_.culled(tree, space, current.key, contexts[current.context], closest_, sink_)) {
            forget_if_last(current.context, top, stack, saved);
            continue;
          }
        }
        if (current.ref.is_leaf()) {
          if constexpr (Unit::kContexts && kTop) {
            set_aside(top, stack, live, saved);  // the instance's own frames take its place
          }
          forget_if_last(current.context, top, stack, saved);
          if (visit_leaf(current.ref)) {
            return true;
          }
          continue;
        }
        if constexpr (Unit::kContexts) {
          if (!switch_context(tree, space, current, fresh, contexts, live, saved, top, stack)) {
            continue;
          }
        }
        break;
      }
    }
  }

  // Visits the hit leaves in slot order and takes them out of the mask.
  template <class VisitLeaf>
  bool visit_hit_leaves(const ChildRef* children, std::uint32_t& mask,
                        const VisitLeaf& visit_leaf) {
    for (std::uint32_t rest = mask; rest != 0; rest &= rest - 1) {
      const auto slot = static_cast<std::uint32_t>(std::countr_zero(rest));
      if (children[slot].is_leaf()) {
        mask &= ~(1U << slot);
        if (visit_leaf(children[slot])) {
          return true;
        }
      }
    }
    return false;
  }

  // Makes the frame that `current`'s children need the live one; false if it cannot be hit.
  bool switch_context(const Tree& tree, const Space& space, const Entry& current, bool fresh,
                      ContextStack& contexts, std::uint32_t& live, std::uint64_t& saved,
                      const Entry* top, const Entry* stack) {
    const std::uint32_t outer = current.context;
    if (!current.ref.opens()) {
      if (outer != live) {
        if constexpr (Sink::kEmits) {
          const auto record = unit_.context_record(tree, contexts[outer]);
          sink_.context_pop(record.traffic, record.address, record.bytes);
        }
        live = outer;
        saved &= ~(std::uint64_t{1} << outer);
      }
      return true;
    }
    forget_if_last(outer, top, stack, saved);
    if (!unit_.open(tree, current.ref.index(), space, contexts.make(outer + 1), current.key, fresh,
                    closest_, sink_)) {
      return false;
    }
    set_aside(top, stack, live, saved);
    live = outer + 1;
    return true;
  }

  // Leaves the live frame; saves it if entries of it remain.
  void set_aside(const Entry* top, const Entry* stack, std::uint32_t& live, std::uint64_t& saved) {
    if (live != kNone && top != stack && top[-1].context == live && (saved >> live & 1U) == 0) {
      sink_.count(EventKind::kContextPush, 1);
      saved |= std::uint64_t{1} << live;
    }
    live = kNone;
  }

  // A frame that was set aside, and whose last entry has just been taken off the stack for
  // something else than going on in it, is not needed any more.
  A2RT_INLINE void forget_if_last(std::uint32_t context, const Entry* top, const Entry* stack,
                                  std::uint64_t& saved) {
    if constexpr (Unit::kContexts) {
      if ((saved >> context & 1U) != 0 && (top == stack || top[-1].context != context)) {
        sink_.context_forget();
        saved &= ~(std::uint64_t{1} << context);
      }
    }
  }

  // Pushes the hit children so that the one to visit next is on top. Equal keys: the lower slot
  // first.
  Entry* push_hits(const Tree& tree, const ChildRef* children, std::uint32_t mask, const Key* keys,
                   std::uint32_t context, Entry* top) const {
    Entry* const base = top;
    if (!s_.traversal.front_to_back) {
      const auto first = static_cast<std::uint32_t>(std::countr_zero(mask));
      for (std::uint32_t rest = mask & (mask - 1); rest != 0; rest &= rest - 1) {
        const auto slot = static_cast<std::uint32_t>(std::countr_zero(rest));
        *top++ = {keys[slot], children[slot], context};
      }
      *top++ = {keys[first], children[first], context};
      return top;
    }
    for (; mask != 0; mask &= mask - 1) {
      const auto slot = static_cast<std::uint32_t>(std::countr_zero(mask));
      const Entry entry{keys[slot], children[slot], context};
      if (!entry.ref.is_leaf()) {
        tree.prefetch(entry.ref);
      }
      Entry* at = top++;
      for (; at != base && at[-1].key <= entry.key; --at) {
        *at = at[-1];
      }
      *at = entry;
    }
    if (s_.traversal.far_first) {
      std::reverse(base, top - 1);
    }
    return top;
  }

  bool visit_instances(ChildRef leaf) {
    for (std::uint32_t i = leaf.first(); i < leaf.first() + leaf.count(); ++i) {
      if (visit_instance(top_->order[i])) {
        return true;
      }
    }
    return false;
  }

  bool visit_instance(std::uint32_t index) {
    instance_ = &top_->instances[index];
    instance_index_ = index;
    sink_.fetch(Traffic::kInstance, instance_->address, s_.layout.instance_bytes);
    if (masked_out(instance_->mask, ray_.mask)) {
      return false;
    }
    const Primitives& primitives = s_.primitives[instance_->blas];
    if ((ray_.flags & (primitives.procedural ? kRaySkipAabbs : kRaySkipTriangles)) != 0) {
      return false;
    }
    if (instance_->identity) {
      // Adding zero turns -0 into +0, as the driver's transform does; it changes nothing else.
      const auto plus_zero = [](const Vec3& v) { return Vec3{v.x + 0.0F, v.y + 0.0F, v.z + 0.0F}; };
      return walk_instance(primitives, plus_zero(ray_.origin), plus_zero(ray_.dir));
    }
    sink_.count(EventKind::kTransform, 1);
    const Vec3 origin = driver_transform_point(instance_->world_to_object, ray_.origin);
    const Vec3 dir = driver_transform_direction(instance_->world_to_object, ray_.dir);
    if (!arith::ray_is_active(origin, dir, ray_.tmin, closest_)) {
      return false;
    }
    sink_.count(EventKind::kRaySetup, 1);
    return walk_instance(primitives, origin, dir);
  }

  // Walks the instance's BLAS with the ray in object space.
  bool walk_instance(const Primitives& primitives, const Vec3& origin, const Vec3& dir) {
    const Tree& tree = s_.blas[instance_->blas];
    const Space space(unit_, origin, dir, ray_.tmin, tree);
    enter_space(origin, dir);
    bool done = false;
    if (primitives.procedural) {
      const arith::SlabRay slab = arith::make_slab_ray(origin, dir, ray_.tmin);
      done = walk<false>(tree, space,
                         [&](ChildRef leaf) { return visit_aabbs(primitives, leaf, slab); });
    } else {
      const FastTriangle test(origin, dir);
      done = walk<false>(tree, space,
                         [&](ChildRef leaf) { return visit_triangles(primitives, leaf, test); });
    }
    leave_space();
    return done;
  }

  bool visit_triangles(const Primitives& primitives, ChildRef leaf, const FastTriangle& test) {
    if constexpr (Sink::kEmits || Sink::kAudits) {
      fetch_triangles(primitives, leaf);
      sink_.count(EventKind::kTriangleTest, leaf.count());
    }
    FastTriangle::Edges edges;
    const std::uint32_t met =
        test.find(primitives.triangles.data() + leaf.first(), leaf.count(), edges);
    return met < leaf.count() && judge_triangles(primitives, leaf, met, test, edges);
  }

  // The leaf's triangle `i`, whose `edges` say that the line meets it, and those behind it.
  A2RT_NOINLINE bool judge_triangles(const Primitives& primitives, ChildRef leaf, std::uint32_t i,
                                     const FastTriangle& test, FastTriangle::Edges& edges) {
    const AxisTriangle* const triangles = primitives.triangles.data() + leaf.first();
    while (i < leaf.count()) {
      float t = 0;
      bool front = false;
      if (test.ahead(edges, t, front) && t <= closest_ &&
          triangle_in_range(t, ray_.tmin, ray_.tmax) &&
          judge_triangle(primitives, leaf.first() + i, t, front)) {
        return true;
      }
      ++i;
      i += test.find(triangles + i, leaf.count() - i, edges);
    }
    return false;
  }

  A2RT_INLINE void fetch_triangles(const Primitives& primitives, ChildRef leaf) {
    if (s_.layout.accounting == Accounting::kRecords) {
      sink_.fetch(Traffic::kTriangle, triangle_address(primitives, leaf.first()),
                  leaf.count() * sizeof(Triangle));
      return;
    }
    for (std::uint32_t i = leaf.first(); i < leaf.first() + leaf.count(); ++i) {
      if (primitives.mesh_slots.empty()) {
        fetch_lines(sink_, s_.layout.accounting, Traffic::kTriangle,
                    triangle_address(primitives, i), sizeof(Triangle));
      } else {
        fetch_index(sink_, s_.layout.accounting, index_address(primitives, i), result_address());
        fetch_lines(sink_, s_.layout.accounting, Traffic::kTriangle,
                    triangle_address(primitives, primitives.mesh_slots[i]), sizeof(Triangle));
      }
    }
  }

  // The candidate rules; true if the ray ends here.
  bool judge_triangle(const Primitives& primitives, std::uint32_t slot, float t, bool front) {
    const PrimitiveId id = primitives.ids[slot];
    if (!beats(t, id)) {
      return false;
    }
    const bool facing = faces_front(front, instance_->flags);
    const bool opaque = is_opaque(id.opaque(), instance_->flags, ray_.flags);
    if (culled_by_facing(facing, instance_->flags, ray_.flags) ||
        culled_by_opacity(opaque, ray_.flags)) {
      return false;
    }
    bool last = (ray_.flags & kRayTerminateOnFirstHit) != 0;
    if (!opaque && (s_.judges_candidates || !candidates_.empty())) {
      const Verdict v =
          any_hit_verdict(candidates_, ray_.flags, instance_index_, id.geometry(), id.primitive);
      if constexpr (Sink::kEmits) {
        sink_.fetch(Traffic::kTriangle, id_address(primitives, slot), s_.layout.id_bytes);
      }
      sink_.count(EventKind::kAnyHit, v.ordinal);
      if (v.verdict == capture::AnyHitVerdict::kIgnore) {
        return false;
      }
      last = last || v.verdict == capture::AnyHitVerdict::kTerminate;
    }
    commit(primitives, slot, t, facing ? kHitKindFront : kHitKindBack);
    return last;
  }

  bool visit_aabbs(const Primitives& primitives, ChildRef leaf, const arith::SlabRay& slab) {
    for (std::uint32_t i = leaf.first(); i < leaf.first() + leaf.count(); ++i) {
      sink_.fetch(Traffic::kAabb, primitives.data + Bytes{i * sizeof(Box)}, sizeof(Box));
      sink_.count(EventKind::kBoxTest, 1);
      const bool opaque = is_opaque(primitives.ids[i].opaque(), instance_->flags, ray_.flags);
      if (!culled_by_opacity(opaque, ray_.flags) &&
          arith::slab_test(slab, primitives.aabbs[i], closest_).hit &&
          replay_reports(primitives, i)) {
        return true;
      }
    }
    return false;
  }

  // The intersection shader runs outside the unit; its recorded reports are what it says.
  bool replay_reports(const Primitives& primitives, std::uint32_t slot) {
    const PrimitiveId id = primitives.ids[slot];
    if constexpr (Sink::kEmits) {
      sink_.fetch(Traffic::kAabb, id_address(primitives, slot), s_.layout.id_bytes);
    }
    sink_.count(EventKind::kIntersection, 1);
    bool done = false;
    for (const Candidate& c : candidates_) {
      if (c.is_report == 0 || c.verdict == 0 || c.primitive != id.primitive ||
          c.instance != instance_index_ || c.geometry != id.geometry() ||
          !report_in_range(c.t, ray_.tmin, closest_) || !beats(c.t, id)) {
        continue;
      }
      commit(primitives, slot, c.t, c.kind);
      const Verdict v =
          any_hit_verdict(candidates_, ray_.flags, instance_index_, id.geometry(), id.primitive);
      done = done || (ray_.flags & kRayTerminateOnFirstHit) != 0 ||
             (v.ordinal != 0xffff && v.verdict == capture::AnyHitVerdict::kTerminate);
    }
    return done;
  }

  // Whether a candidate at t replaces the hit so far.
  bool beats(float t, const PrimitiveId& id) const {
    if (t < closest_ || hit_.state != HitState::kHit) {
      return t <= closest_;
    }
    if (!(t == closest_)) {
      return false;
    }
    if (instance_index_ != hit_.instance) {
      return instance_index_ < hit_.instance;
    }
    if (id.geometry() != hit_.geometry) {
      return id.geometry() < hit_.geometry;
    }
    return id.primitive < hit_.primitive;
  }

  void commit(const Primitives& primitives, std::uint32_t slot, float t, std::uint32_t kind) {
    const PrimitiveId id = primitives.ids[slot];
    closest_ = t;
    hit_ = {HitState::kHit, t, instance_index_, id.geometry(), id.primitive, kind};
    hit_primitives_ = &primitives;
    hit_slot_ = slot;
  }

  void fetch_hit() {
    const Primitives& primitives = *hit_primitives_;
    if (s_.layout.accounting == Accounting::kRecords) {
      sink_.fetch(Traffic::kTriangle, id_address(primitives, hit_slot_), s_.layout.id_bytes);
      return;
    }
    if (!primitives.mesh_slots.empty()) {
      return;  // the public baseline has charged the index, and written, at each test
    }
    fetch_lines(sink_, s_.layout.accounting, Traffic::kTriangle,
                triangle_address(primitives, hit_slot_), sizeof(Triangle));
    fetch_index(sink_, s_.layout.accounting, index_address(primitives, hit_slot_),
                result_address());
  }

  static Address triangle_address(const Primitives& primitives, std::uint32_t slot) {
    return primitives.data + Bytes{slot * sizeof(Triangle)};
  }
  static Address index_address(const Primitives& primitives, std::uint32_t slot) {
    return primitives.id_data + Bytes{std::uint64_t{slot} * kPublishedIndexBytes};
  }
  Address result_address() const {
    const auto ray = static_cast<std::size_t>(&ray_ - s_.first_ray);
    return s_.results + Bytes{(ray < s_.ray_count ? ray : 0) * kPublishedResultBytes};
  }
  Address id_address(const Primitives& primitives, std::uint32_t slot) const {
    return primitives.id_data + Bytes{std::uint64_t{slot} * s_.layout.id_bytes};
  }

  void enter_space(const Vec3& origin, const Vec3& dir) {
    if constexpr (Sink::kAudits) {
      sink_.enter_space(origin, dir, ray_.tmin);
    }
  }
  void leave_space() {
    if constexpr (Sink::kAudits) {
      sink_.leave_space();
    }
  }

  const Unit& unit_;
  const Structures<Unit>& s_;
  const Ray& ray_;
  std::span<const Candidate> candidates_;
  Sink& sink_;
  const SceneTop* top_ = nullptr;
  const InstanceRecord* instance_ = nullptr;
  std::uint32_t instance_index_ = 0;
  float closest_ = 0;
  Hit hit_;
  const Primitives* hit_primitives_ = nullptr;
  std::uint32_t hit_slot_ = 0;
};

}  // namespace a2rt::rt
