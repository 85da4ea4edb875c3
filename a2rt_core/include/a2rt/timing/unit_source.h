// Rays' events from an RT unit, produced when the machine issues them.
#pragma once

#include "a2rt/rt/unit.h"
#include "a2rt/timing/ray_source.h"
#include "a2rt/workload/workload.h"

namespace a2rt::timing {

class UnitSource final : public RaySource {
 public:
  // The unit must have been built on `workload`; both must outlive the source.
  UnitSource(const RtUnit& unit, const Workload& workload) : unit_(unit), workload_(workload) {}

  void prefetch(std::uint32_t ray) const override {
    __builtin_prefetch(&workload_.rays[ray]);
    __builtin_prefetch(&workload_.candidate_first[ray]);
  }
  void events(std::uint32_t ray, EventReceiver& out) override {
    const auto& first = workload_.candidate_first;
    const std::span<const Candidate> candidates =
        std::span(workload_.candidates).subspan(first[ray], first[ray + 1] - first[ray]);
    unit_.trace({&workload_.rays[ray], candidates}, out);
  }

 private:
  const RtUnit& unit_;
  const Workload& workload_;
};

}  // namespace a2rt::timing
