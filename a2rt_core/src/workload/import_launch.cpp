#include "import_launch.h"

#include <algorithm>

#include "a2rt/base/error.h"
#include "a2rt/workload/ray_rules.h"

namespace a2rt::import {
namespace {

using namespace capture;

bool judges_candidates(Stage stage) {
  return stage == Stage::kAnyHit || stage == Stage::kIntersection;
}

bool starts_launch(Stage stage) {
  return stage == Stage::kRayGeneration || stage == Stage::kCompute || stage == Stage::kFragment ||
         stage == Stage::kOther;
}

Hit hit_of(const Record& record) {
  return {HitState::kHit,    record.number(1, 1), record.word(1, 3),
          record.word(2, 0), record.word(1, 2),   record.word(1, 0)};
}

}  // namespace

LaunchParser::LaunchParser(const Manifest& manifest, const RawDispatch& dispatch,
                           std::uint32_t dispatch_index, Workload& workload, OpenEnds& open_ends)
    : manifest_(manifest),
      dispatch_(dispatch),
      dispatch_index_(dispatch_index),
      workload_(workload),
      open_ends_(open_ends) {}

void LaunchParser::record(const Record& record) {
  if (record.kind() == RecordKind::kHit || record.kind() == RecordKind::kMiss) {
    enter(record);
    return;
  }
  Call* call = caller_of(record);
  if (call == nullptr) {
    ++open_ends_.orphans;
    return;
  }
  switch (record.kind()) {
    case RecordKind::kRay:
      begin_ray(*call, record);
      return;
    case RecordKind::kAnyHit:
      call->judged = true;
      add_candidate(*call, record);
      return;
    case RecordKind::kReport:
      add_candidate(*call, record);
      return;
    case RecordKind::kSegment:
      add_segment(record, 1, kNone);
      return;
    case RecordKind::kQueryStep:
      query_step(*call, record);
      return;
    case RecordKind::kQueryVerdict:
      query_verdict(*call, record);
      return;
    default:
      end_call(record);
      return;
  }
}

LaunchParser::Call* LaunchParser::caller_of(const Record& record) {
  return judges_candidates(record.stage()) ? candidate_shader(record) : running(record);
}

// The call of a stage that is known to run, after the calls above it have ended unseen.
LaunchParser::Call* LaunchParser::running(const Record& record) {
  const auto is_writer = [&](const Call& call) {
    return call.stage == record.stage() && call.shader == record.shader();
  };
  const auto found = std::find_if(stack_.rbegin(), stack_.rend(), is_writer);
  if (found != stack_.rend()) {
    while (!is_writer(stack_.back())) {
      pop();
    }
    return &stack_.back();
  }
  const bool begins = (starts_launch(record.stage()) && stack_.empty()) ||
                      (record.stage() == Stage::kCallable && !stack_.empty());
  if (!begins) {
    return nullptr;
  }
  const std::uint32_t ray = stack_.empty() ? kNone : stack_.back().ray;
  stack_.push_back({record.stage(), record.shader(), ray});
  return &stack_.back();
}

// The call of an any-hit or intersection shader, begun with its first record.
LaunchParser::Call* LaunchParser::candidate_shader(const Record& record) {
  if (stack_.empty()) {
    return nullptr;
  }
  const bool is_end = record.kind() == RecordKind::kEnd;
  if (stack_.back().stage == Stage::kAnyHit && stack_.back().judged && !is_end) {
    pop();
  }
  const auto is_writer = [&](const Call& call) {
    return call.stage == record.stage() && call.shader == record.shader();
  };
  if (is_writer(stack_.back())) {
    return &stack_.back();
  }
  // An intersection shader goes on, or ends, after the any-hit shader it called.
  if (record.stage() == Stage::kIntersection && stack_.back().stage == Stage::kAnyHit &&
      stack_.size() > 1 && is_writer(stack_[stack_.size() - 2])) {
    pop();
    return &stack_.back();
  }
  if (record.stage() == Stage::kIntersection && judges_candidates(stack_.back().stage)) {
    pop();
  }
  const Call& top = stack_.back();
  const std::uint32_t ray = judges_candidates(top.stage) ? top.ray : top.trace;
  if (ray == kNone) {
    return nullptr;
  }
  stack_.push_back({record.stage(), record.shader(), ray});
  return &stack_.back();
}

void LaunchParser::enter(const Record& record) {
  while (!stack_.empty() && judges_candidates(stack_.back().stage)) {
    pop();
  }
  const std::uint32_t ray = stack_.empty() ? kNone : stack_.back().trace;
  const Stage expected = record.kind() == RecordKind::kHit ? Stage::kClosestHit : Stage::kMiss;
  if (ray == kNone || record.stage() != expected) {
    ++open_ends_.orphans;
    return;
  }
  Hit& hit = workload_.driver_hits[ray];
  if (record.kind() == RecordKind::kHit) {
    hit = hit_of(record);
  } else {
    hit = Hit{};
  }
  stack_.back().trace = kNone;
  stack_.push_back({record.stage(), record.shader(), ray});
}

void LaunchParser::begin_ray(Call& call, const Record& record) {
  close_trace(call);
  const bool query = manifest_.query_sites.contains({record.shader(), record.word(3, 2)}) ||
                     record.stage() == Stage::kCompute || record.stage() == Stage::kFragment ||
                     judges_candidates(record.stage());
  const std::uint32_t packed = record.word(3, 1);
  Ray ray;
  ray.origin = {record.number(1, 0), record.number(1, 1), record.number(1, 2)};
  ray.tmin = record.number(1, 3);
  ray.dir = {record.number(2, 0), record.number(2, 1), record.number(2, 2)};
  ray.tmax = record.number(2, 3);
  ray.flags = (record.word(3, 0) & kVulkanRayFlags) | (query ? kRayQuery : 0u) |
              (record.word(3, 3) != 0 ? kRayOverridden : 0u);
  ray.mask = packed & 0xff;
  ray.sbt = packed >> 8;
  ray.tlas = tlas_of(record);
  ray.dispatch = dispatch_index_;
  ray.launch = record.launch();
  ray.ordinal = record.ordinal();
  ray.parent = call.ray;
  const auto index = static_cast<std::uint32_t>(workload_.rays.size());
  workload_.rays.push_back(ray);
  Hit unknown;
  unknown.state = HitState::kUnknown;
  workload_.driver_hits.push_back(unknown);
  add_segment(record, 4, index);
  if (query) {
    call.query = index;
    queries_.push_back({index});
  } else {
    call.trace = index;
  }
}

std::uint32_t LaunchParser::tlas_of(const Record& record) const {
  const auto bound = dispatch_.tlas.find({record.shader(), record.word(3, 2)});
  const std::uint32_t tlas =
      bound != dispatch_.tlas.end() && bound->second != kNone ? bound->second : dispatch_.only_tlas;
  if (tlas == kNone) {
    throw UserError("dispatch " + std::to_string(dispatch_.block.dispatch) + ": trace site " +
                    std::to_string(record.word(3, 2)) + " of shader " +
                    std::to_string(record.shader()) +
                    " uses an acceleration structure that the layer could not tell among several");
  }
  return tlas;
}

void LaunchParser::end_call(const Record& record) {
  add_segment(record, 1, kNone);
  pop();
}

void LaunchParser::close_trace(Call& call) {
  if (call.trace != kNone) {
    open_ends_.unrecorded.push_back(call.trace);
    call.trace = kNone;
  }
}

void LaunchParser::pop() {
  close_trace(stack_.back());
  stack_.pop_back();
}

void LaunchParser::add_candidate(const Call& call, const Record& record) {
  const Hit hit = hit_of(record);
  const bool report = record.kind() == RecordKind::kReport;
  candidates_.push_back({call.ray,
                         {hit.instance, hit.geometry, hit.primitive, hit.t, hit.kind,
                          record.word(2, 2), report ? 1u : 0u}});
}

// The query whose ray's ordinal the record names; else the latest one of the call.
LaunchParser::Query* LaunchParser::query_of(const Call& call, const Record& record) {
  const auto latest = [&](auto matches) {
    const auto found = std::find_if(queries_.rbegin(), queries_.rend(), matches);
    return found == queries_.rend() ? nullptr : &*found;
  };
  Query* const named = latest([&](const Query& query) {
    return workload_.rays[query.ray].ordinal + 1 == record.ordinal();
  });
  return named != nullptr ? named
                          : latest([&](const Query& query) { return query.ray == call.query; });
}

void LaunchParser::query_step(const Call& call, const Record& record) {
  Query* query = query_of(call, record);
  if (query == nullptr) {
    ++open_ends_.orphans;
    return;
  }
  query->stepped = true;
  query->more = record.word(2, 2) != 0;
  query->accepted = false;
  if (query->more &&
      (open_ends_.judged_queries.empty() || open_ends_.judged_queries.back() != query->ray)) {
    open_ends_.judged_queries.push_back(query->ray);
  }
  Hit& hit = workload_.driver_hits[query->ray];
  const std::uint32_t type = record.word(1, 0);
  if (type == 0) {
    hit = Hit{};
    return;
  }
  const bool triangle = type == 1;
  const std::uint32_t kind =
      !triangle ? 0 : (record.word(2, 3) != 0 ? kHitKindFront : kHitKindBack);
  hit = {HitState::kHit,    record.number(1, 1), record.word(1, 3),
         record.word(2, 0), record.word(1, 2),   kind};
}

void LaunchParser::query_verdict(const Call& call, const Record& record) {
  Query* query = query_of(call, record);
  if (query == nullptr) {
    ++open_ends_.orphans;
    return;
  }
  if (static_cast<AnyHitVerdict>(record.word(2, 2)) == AnyHitVerdict::kTerminate) {
    // Accepting and terminating is one verdict, if the accepted candidate is a triangle.
    const auto last = std::find_if(candidates_.rbegin(), candidates_.rend(),
                                   [&](const auto& one) { return one.ray == query->ray; });
    const bool tells =
        query->accepted && last != candidates_.rend() && last->candidate.is_report == 0;
    if (tells) {
      last->candidate.verdict = static_cast<std::uint32_t>(AnyHitVerdict::kTerminate);
    }
    query->stopped = !tells;
    return;
  }
  const bool generated = record.word(1, 0) == 1;
  query->accepted = true;
  candidates_.push_back({query->ray,
                         {record.word(1, 3), record.word(2, 0), record.word(1, 2),
                          record.number(1, 1), 0, generated ? 1u : 0u, generated ? 1u : 0u}});
}

// What the latest step said is final if the traversal was complete then. Otherwise nothing is known
// that a traversal could be compared with.
void LaunchParser::finish_query(const Query& query) {
  if (!query.stepped || query.more || query.stopped) {
    workload_.driver_hits[query.ray] = Hit{};
    workload_.driver_hits[query.ray].state = HitState::kUnknown;
  }
}

void LaunchParser::add_segment(const Record& record, std::size_t first_unit, std::uint32_t ray) {
  workload_.segments.push_back(
      {record.launch(), record.shader(), record.counters(first_unit), ray});
}

void LaunchParser::end_launch() {
  while (!stack_.empty()) {
    pop();
  }
  for (const Query& query : queries_) {
    finish_query(query);
  }
  queries_.clear();
  std::stable_sort(candidates_.begin(), candidates_.end(),
                   [](const auto& a, const auto& b) { return a.ray < b.ray; });
  // candidate_first holds, until the import ends, the end of each ray's candidates so far.
  std::size_t next = 0;
  for (std::size_t ray = workload_.candidate_first.size() - 1; ray < workload_.rays.size(); ++ray) {
    while (next < candidates_.size() && candidates_[next].ray == ray) {
      workload_.candidates.push_back(candidates_[next++].candidate);
    }
    workload_.candidate_first.push_back(workload_.candidates.size());
  }
  candidates_.clear();
}

}  // namespace a2rt::import
