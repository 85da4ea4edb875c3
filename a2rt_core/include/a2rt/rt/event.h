// Events: what a traversal does, without any notion of time.
//
// A unit emits the events of one ray in program order. The timing model (timing/) turns them into
// cycles and the energy ledger (energy/) into joules; neither is known here (design principle 5).
#pragma once

#include <cstdint>

namespace a2rt {

// What is read from memory; the report breaks traffic down by it.
enum class Traffic : std::uint8_t {
  kNone = 0,
  kNode = 1,       // FP32 node (baseline, cwbvh parents, clbvh)
  kGroupNode = 2,  // A2RT group node
  kSubNode = 3,    // A2RT sub node or AQB8 quantized node
  kAnchor = 4,     // AQB8 anchor
  kTriangle = 5,
  kAabb = 6,      // procedural primitive
  kInstance = 7,  // transform and BLAS reference
  kStack = 8,     // spilled stack entries (emitted by timing)
  kShader = 9,    // shader loads and stores (emitted by timing)
  // Only in the accounting of AQB8's public code (rt/settings.h):
  kPrimitiveIndex = 10,  // from leaf order to mesh order
  kResult = 11,          // a hit record: written, and nothing waits for it
  kCount = 12
};

enum class EventKind : std::uint8_t {
  kFetch = 0,         // read `bytes` at `address`; the tests that follow wait for it
  kBoxTest = 1,       // `count` accurate FP32 ray-box tests
  kQBoxTest = 2,      // `count` quantized ray-box tests
  kTriangleTest = 3,  // `count` FP32 ray-triangle tests
  kRaySetup = 4,      // per-ray set-up (reciprocal direction)
  kQuantizeRay = 5,   // A2RT: ray quantized for a group
  kAnchorTest = 6,    // AQB8: anchor test and cluster set-up (CLSTR)
  kUpdate = 7,        // AQB8: qy_max refreshed after a closer hit (UPDT)
  kDequantize = 8,    // `count` boxes rebuilt in FP32 (cwbvh, clbvh, escapes)
  kTransform = 9,     // ray transformed into an instance's object space
  kPush = 10,         // `count` entries pushed on the traversal stack
  kPop = 11,          // one entry popped (count = 1), kept or culled by its re-test
  kContextPush = 12,  // group or cluster context set aside
  kContextPop = 13,   // context restored; traffic/address/bytes name the record that a re-fetching
                      // design reads. count = 0: forgotten, as nothing of it is left to do
  kAnyHit = 14,  // candidate leaves the unit for an any-hit shader; `count` = candidate ordinal
  kIntersection = 15,  // candidate leaves the unit for an intersection shader
  kEscape = 16,  // A2RT guard/wide: pair left the quantized range; the kDequantize and kBoxTest
                 // of its `count` boxes follow
  kCount = 17
};

// One event as a value, for those who keep or compare them (event_receiver.h: EventValues).
struct Event {
  EventKind kind = EventKind::kFetch;
  Traffic traffic = Traffic::kNone;  // kFetch, kContextPop
  std::uint16_t count = 1;
  std::uint32_t bytes = 0;    // kFetch, kContextPop
  std::uint64_t address = 0;  // byte address in the simulated GPU's memory
};
static_assert(sizeof(Event) == 16);

}  // namespace a2rt
