// Where the timing model gets a ray's events: an RT unit, or a script in tests.
#pragma once

#include <cstdint>

#include "a2rt/rt/event_receiver.h"

namespace a2rt::timing {

class CompiledRays;
struct RtConfig;

class RaySource {
 public:
  virtual ~RaySource() = default;
  // The ray's events will be asked for soon; may bring what that needs into the host's caches.
  virtual void prefetch(std::uint32_t /*ray*/) const {}
  // Sends the events of ray `ray` (index into Workload::rays) in program order.
  virtual void events(std::uint32_t ray, EventReceiver& out) = 0;
  // Where rays compiled for such RT units are kept; nullptr: nowhere. Valid until others are asked
  // for.
  virtual CompiledRays* compiled(const RtConfig& /*config*/) { return nullptr; }
};

}  // namespace a2rt::timing
