// Where a traversal's events go. The engine is a template on the sink, so that the plain traversal
// pays for none of them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "a2rt/arith/oracle.h"
#include "a2rt/base/inline.h"
#include "a2rt/base/units.h"
#include "a2rt/base/vec.h"
#include "a2rt/bvh/wide_bvh.h"
#include "a2rt/rt/event.h"
#include "a2rt/rt/event_receiver.h"
#include "a2rt/rt/unit.h"

namespace a2rt::rt {

// No events, no audit: speed.
struct NullSink {
  static constexpr bool kEmits = false;
  static constexpr bool kAudits = false;
  void fetch(Traffic, Address, std::uint64_t) {}
  void count(EventKind, std::size_t) {}
  void context_pop(Traffic, Address, std::uint64_t) {}
  void context_forget() {}
};

// Hands events on, in program order.
class EventSink {
 public:
  static constexpr bool kEmits = true;
  static constexpr bool kAudits = false;
  explicit EventSink(EventReceiver& to) : to_(to) {}

  void fetch(Traffic traffic, Address address, std::uint64_t bytes) {
    to_.fetch(traffic, address, static_cast<std::uint32_t>(bytes));
  }
  A2RT_INLINE void count(EventKind kind, std::size_t n) {
    send_count(kind, static_cast<std::uint32_t>(n < 0xffff ? n : 0xffff), to_);
  }
  void context_pop(Traffic traffic, Address address, std::uint64_t bytes) {
    to_.context_pop(traffic, address, static_cast<std::uint32_t>(bytes));
  }
  void context_forget() { to_.context_forget(); }

 private:
  EventReceiver& to_;
};

// Compares every decision about a box with exact arithmetic on the original box.
class AuditSink {
 public:
  static constexpr bool kEmits = false;
  static constexpr bool kAudits = true;
  explicit AuditSink(Audit& audit) : audit_(audit) {}

  void fetch(Traffic, Address, std::uint64_t) {}
  void context_pop(Traffic, Address, std::uint64_t) {}
  void context_forget() {}
  void count(EventKind kind, std::size_t n) {
    audit_.box_tests += kind == EventKind::kBoxTest ? n : 0;
    audit_.qbox_tests += kind == EventKind::kQBoxTest ? n : 0;
    audit_.triangle_tests += kind == EventKind::kTriangleTest ? n : 0;
    audit_.escapes += kind == EventKind::kEscape ? n : 0;
  }

  // The ray of the structure being traversed; the decisions that follow are about it.
  void enter_space(const Vec3& origin, const Vec3& direction, float tmin) {
    rays_.emplace_back(origin, direction, tmin);
  }
  void leave_space() { rays_.pop_back(); }
  // `quantized`, `hit`: masks over the boxes. `explain(i)` names what made box i be missed.
  template <class Explain>
  void decide(std::span<const bvh::BvhRecord> boxes, std::uint32_t quantized, std::uint32_t hit,
              float tmax, const Explain& explain) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if ((quantized >> i & 1U) == 0) {
        continue;
      }
      const bool exact = arith::ray_meets_box(rays_.back(), boxes[i].box, tmax);
      const bool found = (hit >> i & 1U) != 0;
      ++audit_.decided;
      audit_.exact_hits += exact ? 1U : 0U;
      audit_.redundant_hits += found && !exact ? 1U : 0U;
      if (exact && !found) {
        ++audit_.missed_hits;
        ++audit_.missed_by_mechanism[explain(i)];
      }
    }
  }
  // The same for the boxes of `tested` that an FP32 unit decided.
  void decide_fp32(std::span<const bvh::BvhRecord> boxes, std::uint32_t tested, std::uint32_t hit,
                   float tmax, const char* mechanism) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if ((tested >> i & 1U) == 0) {
        continue;
      }
      const bool exact = arith::ray_meets_box(rays_.back(), boxes[i].box, tmax);
      const bool found = (hit >> i & 1U) != 0;
      audit_.fp32_exact_hits += exact ? 1U : 0U;
      audit_.fp32_redundant_hits += found && !exact ? 1U : 0U;
      if (exact && !found) {
        ++audit_.fp32_missed_hits;
        ++audit_.missed_by_mechanism[mechanism];
      }
    }
  }

 private:
  Audit& audit_;
  std::vector<arith::OracleRay> rays_;
};

}  // namespace a2rt::rt
