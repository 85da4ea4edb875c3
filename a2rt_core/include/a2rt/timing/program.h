// What the SMs run: the captured segments of each launch id, and what they cost a warp.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "a2rt/capture/records.h"
#include "a2rt/timing/rt_engine.h"
#include "a2rt/workload/workload.h"

namespace a2rt::timing {

using Counts = std::array<std::uint32_t, capture::kCounters>;

// Segments of one dispatch, by launch id. A workload without segments (rays only) gets one empty
// segment per ray, so that its rays can be timed without shaders.
class DispatchProgram {
 public:
  // `workload` must outlive the program.
  DispatchProgram(const Workload& workload, std::size_t dispatch);

  std::uint32_t launches() const { return static_cast<std::uint32_t>(first_.size() - 1); }
  std::span<const Segment> segments() const { return segments_; }
  // Segments of launch `l` are [first(l), first(l + 1)).
  std::uint32_t first(std::uint32_t launch) const { return first_[launch]; }
  bool from_capture() const { return from_capture_; }

 private:
  std::vector<Segment> made_;
  std::span<const Segment> segments_;
  std::vector<std::uint32_t> first_;
  bool from_capture_ = true;
};

// What a shader does between two points where its warp must wait; maxima over the warp's lanes.
struct SegmentWork {
  std::uint32_t shader = 0;
  Counts counts{};                                  // maximum over lanes: what the warp issues
  std::uint64_t lane_sum[capture::kCounters] = {};  // sum over lanes: what is computed
  std::uint32_t lanes = 0;                          // bit per lane
};

// The lanes of one warp on their way through their segments. Lanes in the same shader at the same
// depth advance together; the deepest group goes first, as on a SIMT stack.
class WarpProgram {
 public:
  WarpProgram() = default;
  // Lanes are launch ids first .. first + count - 1.
  WarpProgram(const Workload& workload, const DispatchProgram& program, std::uint32_t first,
              std::uint32_t count);

  // The next group's segment, or false if all lanes have ended.
  bool next(SegmentWork& work, LaneRays& rays_after);
  // Cost of judging candidates: the captured any-hit or intersection segments of each lane's ray.
  // Takes the lanes of one shader out of `jobs`; false if `jobs` is empty.
  bool next_judgement(std::vector<CandidateJob>& jobs, SegmentWork& work) const;

  std::uint32_t launch(std::uint32_t lane) const { return first_launch_ + lane; }
  // Ray whose hit the lane's shader is working on; kNone before the first.
  std::uint32_t last_ray(std::uint32_t lane) const { return lanes_[lane].ray; }

 private:
  struct Lane {
    std::uint32_t next = 0, end = 0;
    std::uint32_t judge_first = 0, judge_end = 0;  // candidate segments of the last ray
    std::uint32_t ray = kNone;
    std::uint32_t depth = 1;
  };
  bool is_judgement(const Segment& segment) const;
  std::uint32_t depth_of_next(const Lane& lane) const;
  void take_judgements(Lane& lane);

  const Workload* workload_ = nullptr;
  const DispatchProgram* program_ = nullptr;
  std::uint32_t first_launch_ = 0;
  std::array<Lane, kLanes> lanes_{};
};

}  // namespace a2rt::timing
