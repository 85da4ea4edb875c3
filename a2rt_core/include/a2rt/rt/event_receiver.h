// Who takes a ray's events, one by one and in program order, while the ray is traversed: no list
// lies between a traversal and what is made of it, and a receiver need not ask of what kind an
// event is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/base/inline.h"
#include "a2rt/base/units.h"
#include "a2rt/rt/event.h"

namespace a2rt {

class EventReceiver {
 public:
  virtual ~EventReceiver() = default;
  virtual void fetch(Traffic traffic, Address address, std::uint32_t bytes) = 0;
  // The kinds that a tester works on, kBoxTest to kTransform.
  virtual void test(EventKind kind, std::uint32_t count) = 0;
  virtual void push(std::uint32_t count) = 0;
  virtual void pop(std::uint32_t count) = 0;
  virtual void context_push() = 0;
  virtual void context_pop(Traffic traffic, Address address, std::uint32_t bytes) = 0;
  virtual void context_forget() = 0;
  // kAnyHit and kIntersection.
  virtual void leave_unit(EventKind kind, std::uint32_t count) = 0;
  virtual void escape(std::uint32_t count) = 0;

 protected:
  EventReceiver() = default;
  EventReceiver(const EventReceiver&) = default;
  EventReceiver& operator=(const EventReceiver&) = default;
};

// An event that names no memory. Where the kind is a constant, only its own call remains.
A2RT_INLINE void send_count(EventKind kind, std::uint32_t count, EventReceiver& to) {
  switch (kind) {
    case EventKind::kBoxTest:
    case EventKind::kQBoxTest:
    case EventKind::kTriangleTest:
    case EventKind::kRaySetup:
    case EventKind::kQuantizeRay:
    case EventKind::kAnchorTest:
    case EventKind::kUpdate:
    case EventKind::kDequantize:
    case EventKind::kTransform:
      return to.test(kind, count);
    case EventKind::kPush:
      return to.push(count);
    case EventKind::kPop:
      return to.pop(count);
    case EventKind::kContextPush:
      return to.context_push();
    case EventKind::kAnyHit:
    case EventKind::kIntersection:
      return to.leave_unit(kind, count);
    case EventKind::kEscape:
      return to.escape(count);
    case EventKind::kFetch:
    case EventKind::kContextPop:
    case EventKind::kCount:
      break;
  }
  A2RT_CHECK(false, "an event of unknown kind, or one that names memory");
}

// Events that were written down.
inline void send(const std::vector<Event>& events, EventReceiver& to) {
  for (const Event& e : events) {
    if (e.kind == EventKind::kFetch) {
      to.fetch(e.traffic, Address{e.address}, e.bytes);
    } else if (e.kind != EventKind::kContextPop) {
      send_count(e.kind, e.count, to);
    } else if (e.count == 0) {
      to.context_forget();
    } else {
      to.context_pop(e.traffic, Address{e.address}, e.bytes);
    }
  }
}

// Hands each event to `take` as one value.
template <class Take>
class EventValues final : public EventReceiver {
 public:
  explicit EventValues(Take take) : take_(std::move(take)) {}

  void fetch(Traffic traffic, Address address, std::uint32_t bytes) override {
    take_(Event{EventKind::kFetch, traffic, 1, bytes, address.value});
  }
  void test(EventKind kind, std::uint32_t count) override { counted(kind, count); }
  void push(std::uint32_t count) override { counted(EventKind::kPush, count); }
  void pop(std::uint32_t count) override { counted(EventKind::kPop, count); }
  void context_push() override { counted(EventKind::kContextPush, 1); }
  void context_pop(Traffic traffic, Address address, std::uint32_t bytes) override {
    take_(Event{EventKind::kContextPop, traffic, 1, bytes, address.value});
  }
  void context_forget() override { counted(EventKind::kContextPop, 0); }
  void leave_unit(EventKind kind, std::uint32_t count) override { counted(kind, count); }
  void escape(std::uint32_t count) override { counted(EventKind::kEscape, count); }

 private:
  void counted(EventKind kind, std::uint32_t count) {
    take_(Event{kind, Traffic::kNone, static_cast<std::uint16_t>(count), 0, 0});
  }
  Take take_;
};

}  // namespace a2rt
