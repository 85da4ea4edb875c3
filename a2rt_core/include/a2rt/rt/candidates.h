// What the shaders said about a candidate, from the driver's run.
//
// Rule for a candidate that no shader judged (the driver had already found something closer, or had
// stopped): of a traced ray it is accepted. Either it lies beyond the driver's hit, then a nearer
// accepted hit replaces it in any order of visits; or its hit group has no any-hit shader, then
// Vulkan accepts it. Of a ray query it is not a hit, as only the program could have confirmed it.
// A candidate judged several times (ray queries) keeps its last verdict.
#pragma once

#include <cstdint>
#include <span>

#include "a2rt/capture/records.h"
#include "a2rt/workload/workload.h"

namespace a2rt::rt {

struct Verdict {
  capture::AnyHitVerdict verdict = capture::AnyHitVerdict::kAccept;
  std::uint32_t ordinal = 0xffff;  // position among the ray's candidates; 0xffff: never judged
};

inline Verdict any_hit_verdict(std::span<const Candidate> candidates, std::uint32_t ray_flags,
                               std::uint32_t instance, std::uint32_t geometry,
                               std::uint32_t primitive) {
  for (std::size_t i = candidates.size(); i-- > 0;) {
    const Candidate& c = candidates[i];
    if (c.is_report == 0 && c.primitive == primitive && c.instance == instance &&
        c.geometry == geometry) {
      return {static_cast<capture::AnyHitVerdict>(c.verdict), static_cast<std::uint32_t>(i)};
    }
  }
  return {(ray_flags & kRayQuery) != 0 ? capture::AnyHitVerdict::kIgnore
                                       : capture::AnyHitVerdict::kAccept};
}

}  // namespace a2rt::rt
