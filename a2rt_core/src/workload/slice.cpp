#include "a2rt/workload/slice.h"

namespace a2rt {

Workload slice(const Workload& workload,
               const std::function<bool(std::uint32_t, std::uint32_t)>& keep) {
  Workload out;
  out.provenance = workload.provenance;
  out.blas = workload.blas;
  out.tlas = workload.tlas;
  out.shaders = workload.shaders;
  out.candidate_first.push_back(0);
  std::vector<std::uint32_t> renumbered(workload.rays.size(), kNone);
  for (std::uint32_t d = 0; d < workload.dispatches.size(); ++d) {
    Dispatch dispatch = workload.dispatches[d];
    const std::uint64_t first_ray = dispatch.first_ray, first_segment = dispatch.first_segment;
    dispatch.first_ray = out.rays.size();
    dispatch.first_segment = out.segments.size();
    for (std::uint64_t i = first_ray; i < first_ray + dispatch.ray_count; ++i) {
      Ray ray = workload.rays[i];
      if (!keep(d, ray.launch)) {
        continue;
      }
      renumbered[i] = static_cast<std::uint32_t>(out.rays.size());
      ray.parent = ray.parent == kNone ? kNone : renumbered[ray.parent];
      out.rays.push_back(ray);
      out.driver_hits.push_back(workload.driver_hits[i]);
      for (std::uint64_t c = workload.candidate_first[i]; c < workload.candidate_first[i + 1];
           ++c) {
        out.candidates.push_back(workload.candidates[c]);
      }
      out.candidate_first.push_back(out.candidates.size());
    }
    for (std::uint64_t i = first_segment; i < first_segment + dispatch.segment_count; ++i) {
      Segment segment = workload.segments[i];
      if (keep(d, segment.launch)) {
        segment.ray = segment.ray == kNone ? kNone : renumbered[segment.ray];
        out.segments.push_back(segment);
      }
    }
    dispatch.ray_count = out.rays.size() - dispatch.first_ray;
    dispatch.segment_count = out.segments.size() - dispatch.first_segment;
    out.dispatches.push_back(dispatch);
  }
  return out;
}

}  // namespace a2rt
