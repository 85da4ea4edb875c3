#include "a2rt/timing/program.h"

#include <algorithm>

#include "a2rt/base/error.h"

namespace a2rt::timing {
namespace {

capture::Stage stage_of(const Workload& workload, std::uint32_t shader) {
  return shader < workload.shaders.size()
             ? static_cast<capture::Stage>(workload.shaders[shader].stage)
             : capture::Stage::kRayGeneration;
}

void add_lane(SegmentWork& work, std::uint32_t lane, const Segment& segment) {
  work.lanes |= 1u << lane;
  work.shader = segment.shader;
  for (std::size_t c = 0; c < capture::kCounters; ++c) {
    work.counts[c] = std::max(work.counts[c], segment.counts[c]);
    work.lane_sum[c] += segment.counts[c];
  }
}

}  // namespace

DispatchProgram::DispatchProgram(const Workload& workload, std::size_t dispatch) {
  const Dispatch& d = workload.dispatches.at(dispatch);
  const std::uint64_t launches = std::uint64_t{d.width} * d.height * d.depth;
  if (d.segment_count > 0) {
    segments_ = std::span(workload.segments).subspan(d.first_segment, d.segment_count);
  } else {
    from_capture_ = false;
    for (std::uint64_t r = d.first_ray; r < d.first_ray + d.ray_count; ++r) {
      Segment segment;
      segment.launch = workload.rays[r].launch;
      segment.shader = kNone;
      segment.ray = static_cast<std::uint32_t>(r);
      made_.push_back(segment);
    }
    segments_ = made_;
  }
  first_.assign(launches + 1, 0);
  std::uint32_t last = 0;
  for (const Segment& s : segments_) {
    if (s.launch >= launches || s.launch < last) {
      throw UserError("workload: segments of dispatch " + std::to_string(dispatch) +
                      " are not sorted by launch id; import the capture again");
    }
    last = s.launch;
    ++first_[s.launch + 1];
  }
  for (std::size_t l = 1; l < first_.size(); ++l) {
    first_[l] += first_[l - 1];
  }
}

WarpProgram::WarpProgram(const Workload& workload, const DispatchProgram& program,
                         std::uint32_t first, std::uint32_t count)
    : workload_(&workload), program_(&program), first_launch_(first) {
  A2RT_CHECK(count <= kLanes, "a warp has at most 32 lanes");
  for (std::uint32_t l = 0; l < count; ++l) {
    lanes_[l].next = program.first(first + l);
    lanes_[l].end = program.first(first + l + 1);
  }
}

bool WarpProgram::is_judgement(const Segment& segment) const {
  const capture::Stage stage = stage_of(*workload_, segment.shader);
  return stage == capture::Stage::kAnyHit || stage == capture::Stage::kIntersection;
}

// Candidate segments follow the segment that traced their ray; they run when the RT unit asks.
void WarpProgram::take_judgements(Lane& lane) {
  lane.judge_first = lane.next;
  while (lane.next < lane.end && is_judgement(program_->segments()[lane.next])) {
    ++lane.next;
  }
  lane.judge_end = lane.next;
}

std::uint32_t WarpProgram::depth_of_next(const Lane& lane) const {
  const capture::Stage stage = stage_of(*workload_, program_->segments()[lane.next].shader);
  const bool callee = stage == capture::Stage::kClosestHit || stage == capture::Stage::kMiss ||
                      stage == capture::Stage::kCallable;
  return callee ? lane.depth + 1 : lane.depth;
}

bool WarpProgram::next(SegmentWork& work, LaneRays& rays_after) {
  // Neighbouring launches' segments lie apart, and nothing else has touched them: all at once.
  for (const Lane& lane : lanes_) {
    if (lane.next != lane.end) {
      const Segment* segment = &program_->segments()[lane.next];
      __builtin_prefetch(segment);
      __builtin_prefetch(segment + 1);  // most of it may be in the next line of the host
    }
  }
  // The deepest comes first, then the lowest shader.
  std::array<std::uint64_t, kLanes> ranks;
  std::uint64_t best = 0;
  for (std::uint32_t l = 0; l < kLanes; ++l) {
    const Lane& lane = lanes_[l];
    ranks[l] = lane.next == lane.end ? 0
                                     : std::uint64_t{depth_of_next(lane)} << 32 |
                                           ~program_->segments()[lane.next].shader;
    best = std::max(best, ranks[l]);
  }
  if (best == 0) {
    return false;
  }
  const auto depth = static_cast<std::uint32_t>(best >> 32);
  work = {};
  rays_after.fill(kNone);
  for (std::uint32_t l = 0; l < kLanes; ++l) {
    if (ranks[l] != best) {
      continue;
    }
    Lane& lane = lanes_[l];
    const Segment& segment = program_->segments()[lane.next++];
    add_lane(work, l, segment);
    rays_after[l] = segment.ray;
    if (segment.ray != kNone) {
      lane.ray = segment.ray;
      lane.depth = depth;
      take_judgements(lane);
    } else {
      lane.depth = depth > 1 ? depth - 1 : 1;
    }
  }
  return true;
}

bool WarpProgram::next_judgement(std::vector<CandidateJob>& jobs, SegmentWork& work) const {
  if (jobs.empty()) {
    return false;
  }
  work = {};
  // A unit may ask for more candidates than the driver did: the last captured one stands for them.
  const auto segment_of = [&](const CandidateJob& job) -> const Segment* {
    const Lane& lane = lanes_[job.lane];
    const std::uint32_t captured = lane.judge_end - lane.judge_first;
    return captured == 0
               ? nullptr
               : &program_->segments()[lane.judge_first + std::min(job.ordinal, captured - 1)];
  };
  const Segment* first = segment_of(jobs.front());
  const std::uint32_t shader = first != nullptr ? first->shader : kNone;
  std::erase_if(jobs, [&](const CandidateJob& job) {
    const Segment* segment = segment_of(job);
    if ((segment != nullptr ? segment->shader : kNone) != shader) {
      return false;
    }
    if (segment != nullptr) {
      add_lane(work, job.lane, *segment);
    } else {
      work.shader = kNone;
      work.lanes |= 1u << job.lane;
    }
    return true;
  });
  return true;
}

}  // namespace a2rt::timing
