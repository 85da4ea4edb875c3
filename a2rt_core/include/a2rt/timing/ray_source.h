// Where the timing model gets a ray's events: an RT unit, or a script in tests.
#pragma once

#include <cstdint>
#include <vector>

#include "a2rt/rt/event.h"

namespace a2rt::timing {

class RaySource {
 public:
  virtual ~RaySource() = default;
  // Appends the events of ray `ray` (index into Workload::rays) in program order.
  virtual void events(std::uint32_t ray, std::vector<Event>& out) = 0;
};

}  // namespace a2rt::timing
