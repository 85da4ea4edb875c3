// Warp buffer and ray state machines; the port is in rt_engine_port.cpp.
#include "a2rt/timing/rt_engine.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace a2rt::timing {
namespace {

// The part of a GPU-wide count that unit `index` of `units` gets, spread evenly.
std::uint32_t share(std::uint32_t total, std::uint32_t index, std::uint32_t units) {
  return total / units + (index < total % units ? 1 : 0);
}

constexpr std::ptrdiff_t kOpsPerHostLine = 64 / sizeof(LaneOp);

}  // namespace

RtEngine::RtEngine(const MachineConfig& config, std::uint32_t index, Calendar& calendar,
                   L1Cache& l1, RaySource& source, RtHost& host)
    : config_(config),
      index_(index),
      calendar_(calendar),
      l1_(l1),
      source_(source),
      host_(host),
      slots_(config.rt.warps),
      port_(config.rt.port_sectors, ClockDomain(config.rt.mhz, config.core_mhz)),
      compiler_(config.rt) {
  for (std::size_t t = 0; t < kTesters; ++t) {
    const TesterConfig& c = config.rt.testers[t];
    std::uint32_t count = share(c.count, index, config.sm.count);
    if (c.count > 0 && count == 0) {
      throw UserError("rt.testers." + std::string(tester_name(static_cast<Tester>(t))) +
                      ".count = " + std::to_string(c.count) +
                      " leaves an RT unit without one; use 0 or at least " +
                      std::to_string(config.sm.count));
    }
    pools_[t] =
        TesterPool(count, c.latency, c.interval, ClockDomain(config.rt.mhz, config.core_mhz));
  }
}

void RtEngine::accept(Cycles now, std::uint32_t warp, LaneRays rays) {
  A2RT_CHECK(has_room(), "the RT unit was given a warp without having room");
  account_series(now);
  account(now);
  std::uint32_t index = 0;
  while (slots_[index].used) {
    ++index;
  }
  Slot& slot = slots_[index];
  slot.used = true;
  slot.rank = resident_;
  slot.judging = false;
  slot.warp = warp;
  slot.active = slot.suspended = slot.away = 0;
  slot.requests.clear();
  by_age_.push_back(index);
  slot.arrived = now;
  ++resident_;
  ++counts_.warps;
  compile(now, index, rays);
  A2RT_CHECK(slot.active > 0, "a warp without rays was sent to the RT unit");
  for (std::uint32_t l = 0; l < kLanes; ++l) {
    if (rays[l] != kNone) {
      set_state(now, slot.lanes[l], LaneState::kInUnit);
      run_lane(now, now, index, l);
    }
  }
}

void RtEngine::compile(Cycles now, std::uint32_t index, const LaneRays& rays) {
  Slot& slot = slots_[index];
  for (const std::uint32_t ray : rays) {
    if (ray != kNone) {
      source_.prefetch(ray);
    }
  }
  std::array<std::size_t, kLanes> first{};
  slot.ops.clear();
  for (std::uint32_t l = 0; l < kLanes; ++l) {
    slot.lanes[l] = {};
    slot.lanes[l].started = now;
    first[l] = slot.ops.size();
    if (rays[l] != kNone) {
      events_.clear();
      source_.events(rays[l], events_);
      compiler_.compile(events_, spill_memory(index, l), slot.ops);
      ++slot.active;
      ++counts_.rays;
    }
  }
  for (std::uint32_t l = 0; l < kLanes; ++l) {
    slot.lanes[l].op = slot.ops.data() + first[l];
  }
}

void RtEngine::set_state(Cycles now, Lane& lane, LaneState state) {
  switch (lane.state) {
    case LaneState::kInUnit:
      --in_unit_;
      break;
    case LaneState::kCandidate:
    case LaneState::kAtShader:
      end(LaneReason::kShader, now);
      --in_shader_;
      break;
    case LaneState::kDone:
      end(LaneReason::kDone, now);
      break;
    case LaneState::kNone:
      break;
  }
  lane.state = state;
  switch (state) {
    case LaneState::kInUnit:
      ++in_unit_;
      break;
    case LaneState::kCandidate:
    case LaneState::kAtShader:
      begin(LaneReason::kShader, now);
      ++in_shader_;
      break;
    case LaneState::kDone:
      begin(LaneReason::kDone, now);
      break;
    case LaneState::kNone:
      break;
  }
}

A2RT_INLINE void RtEngine::kick_port(Cycles now) {
  if (port_booked_ || port_blocked_) {
    return;
  }
  port_booked_ = true;
  calendar_.at(port_.next(now), *this, kPort);
}

A2RT_INLINE void RtEngine::appoint(Cycles now, Cycles at, std::uint32_t slot, std::uint32_t l) {
  if (at.value - now.value >= kNear) [[unlikely]] {
    calendar_.at(at, *this, kLane, slot * kLanes + l);
    return;
  }
  const auto near = static_cast<std::uint32_t>(at.value % kNear);
  std::uint32_t& lanes = slots_[slot].wake_at[near];
  if (lanes == 0) {
    calendar_.at(at, *this, kNearLanes, slot * kNear + near);
  }
  lanes |= 1u << l;
}

void RtEngine::fail_without(Tester tester) const {
  throw UserError("the RT unit needs a tester that the machine does not have: set rt.testers." +
                  std::string(tester_name(tester)) + ".count above 0");
}

A2RT_INLINE Cycles RtEngine::issue(Cycles at, Tester tester, std::uint32_t count) {
  TesterPool& pool = pools_[static_cast<std::size_t>(tester)];
  if (!pool.exists()) [[unlikely]] {
    fail_without(tester);
  }
  return pool.issue(at, count);
}

// Reserves the testers of the tests that follow. Returns when the lane is through with them.
A2RT_INLINE Cycles RtEngine::run_tests(Cycles now, Cycles at, Lane& lane) {
  const Cycles start = at;
  // Reservations may be out of order by so much only; the rest is worked out when time has come.
  const Cycles horizon = now + Cycles{TesterPool::kDisorder};
  const LaneOp* next = lane.op;
  for (; next->is_test() && at < horizon; ++next) {
    if (next->code() == LaneOp::Code::kTest) [[likely]] {
      at = issue(at, next->tester(), next->count());
    } else {
      at = std::max(issue(at, Tester::kBox, next->count()),
                    issue(at, Tester::kQBox, next->second()));
    }
  }
  lane.op = next;
  lane_cycles(LaneReason::kTest) += at.value - start.value;
  testing_.mark(start, at);
  return at;
}

void RtEngine::run_lane(Cycles now, Cycles at, std::uint32_t slot, std::uint32_t l) {
  Lane& lane = slots_[slot].lanes[l];
  while (true) {
    if (lane.op->is_test()) {
      at = run_tests(now, at, lane);
    }
    if (at > now) {
      appoint(now, at, slot, l);
      return;
    }
    const LaneOp op = *lane.op++;
    switch (op.code()) {
      case LaneOp::Code::kRead:
        read(now, slot, l, op);
        return;
      case LaneOp::Code::kStore:
        stores_.push_back({op.line(), op.sectors(), op.kind()});
        kick_port(now);
        break;
      case LaneOp::Code::kAnyHit:
      case LaneOp::Code::kIntersection:
        suspend(now, slot, l, op);
        return;
      case LaneOp::Code::kEnd:
        end_ray(now, slot, l);
        return;
      default:
        A2RT_CHECK(false, "a lane was given an operation of no meaning");
    }
  }
}

A2RT_INLINE void RtEngine::read(Cycles now, std::uint32_t slot, std::uint32_t l, LaneOp op) {
  Slot& s = slots_[slot];
  Lane& lane = s.lanes[l];
  const LaneOp* next = lane.op;
  std::uint32_t missing = 0;
  Cycles ready = now;
  while (true) {
    missing += s.requests.add(now, l, op.line(), op.sectors(), op.kind(), ready);
    if (op.last()) {
      break;
    }
    op = *next++;
  }
  // Many other lanes have their turn until this one reads on.
  __builtin_prefetch(next + kOpsPerHostLine);
  lane.op = next;
  lane.ready = ready;
  if (missing > 0) {
    lane.missing = static_cast<std::uint16_t>(missing);
    begin(LaneReason::kFetch, now);
    update_asking(s);
    kick_port(now);
    return;
  }
  // All of it is on its way to another lane already.
  lane_cycles(LaneReason::kFetch) += ready.value - now.value;
  appoint(now, ready, slot, l);
}

void RtEngine::suspend(Cycles now, std::uint32_t slot, std::uint32_t l, LaneOp op) {
  Slot& s = slots_[slot];
  Lane& lane = s.lanes[l];
  lane.ordinal = static_cast<std::uint16_t>(op.count());
  lane.intersection = op.code() == LaneOp::Code::kIntersection;
  account_series(now);
  account(now);
  set_state(now, lane, LaneState::kCandidate);
  ++s.suspended;
  maybe_judge(now, slot);
}

void RtEngine::maybe_judge(Cycles now, std::uint32_t slot) {
  Slot& s = slots_[slot];
  if (s.judging || s.suspended == 0) {
    return;
  }
  const std::uint32_t threshold = config_.rt.callback_lanes;
  const bool enough = threshold > 0 && s.suspended >= threshold;
  if (!enough && s.active > s.suspended) {
    return;
  }
  s.jobs.clear();
  for (std::uint32_t l = 0; l < kLanes; ++l) {
    if (s.lanes[l].state == LaneState::kCandidate) {
      set_state(now, s.lanes[l], LaneState::kAtShader);
      s.jobs.push_back({l, s.lanes[l].ordinal, s.lanes[l].intersection});
    }
  }
  s.away = s.suspended;
  s.suspended = 0;
  s.judging = true;
  ++counts_.round_trips;
  counts_.candidates += s.jobs.size();
  host_.judge(now + config_.rt.callback_latency, s.warp, s.jobs);
}

void RtEngine::candidates_done(Cycles now, std::uint32_t warp) {
  std::uint32_t slot = 0;
  while (slot < slots_.size() && !(slots_[slot].used && slots_[slot].warp == warp)) {
    ++slot;
  }
  A2RT_CHECK(slot < slots_.size() && slots_[slot].judging,
             "shaders answered for a warp that had not asked");
  Slot& s = slots_[slot];
  for (const CandidateJob& job : s.jobs) {
    calendar_.at(now + config_.rt.callback_latency, *this, kLane, slot * kLanes + job.lane);
  }
}

void RtEngine::end_ray(Cycles now, std::uint32_t slot, std::uint32_t l) {
  Slot& s = slots_[slot];
  account_series(now);
  account(now);
  set_state(now, s.lanes[l], LaneState::kDone);
  host_.ray_time(s.warp, l, now - s.lanes[l].started);
  if (--s.active == 0) {
    end_warp(now, slot);
  } else {
    maybe_judge(now, slot);
  }
}

void RtEngine::end_warp(Cycles now, std::uint32_t slot) {
  Slot& s = slots_[slot];
  A2RT_CHECK(s.requests.live() == 0, "a warp ended with requests under way");
  std::uint32_t inactive = 0;
  for (Lane& lane : s.lanes) {
    if (lane.state == LaneState::kDone) {
      set_state(now, lane, LaneState::kNone);
    } else {
      ++inactive;
    }
  }
  const Cycles residence = now - s.arrived;
  counts_.lane_cycles[static_cast<std::size_t>(LaneReason::kInactive)] +=
      inactive * residence.value;
  counts_.warp_cycles += residence.value;
  s.used = false;
  forget_rank(s.rank);
  --resident_;
  host_.rays_done(now, s.warp, now + config_.rt.return_latency);
  host_.slot_free(now);
}

// Those behind it move up.
void RtEngine::forget_rank(std::uint32_t rank) {
  by_age_.erase(by_age_.begin() + rank);
  for (std::size_t r = rank; r < by_age_.size(); ++r) {
    slots_[by_age_[r]].rank = static_cast<std::uint32_t>(r);
  }
  const std::uint64_t older = (std::uint64_t{1} << rank) - 1;
  asking_ = (asking_ & older) | (asking_ >> 1 & ~older);
}

void RtEngine::wake(Cycles now, std::uint32_t what, std::uint32_t value) {
  calendar_.progress();
  switch (what) {
    case kNearLanes: {
      const std::uint32_t slot = value / kNear;
      std::uint32_t lanes = std::exchange(slots_[slot].wake_at[value % kNear], 0);
      for (; lanes != 0; lanes &= lanes - 1) {
        const auto l = static_cast<std::uint32_t>(std::countr_zero(lanes));
        Lane& lane = slots_[slot].lanes[l];
        if (lane.op->code() == LaneOp::Code::kRead) [[likely]] {
          read(now, slot, l, *lane.op++);
        } else {
          run_lane(now, now, slot, l);
        }
      }
      return;
    }
    case kPort:
      run_port(now);
      return;
    case kLane: {
      const std::uint32_t slot = value / kLanes, l = value % kLanes;
      if (slots_[slot].lanes[l].state == LaneState::kAtShader) {
        back_from_shader(now, slot, l);
      } else {
        run_lane(now, now, slot, l);
      }
      return;
    }
    default:
      A2RT_CHECK(false, "unknown appointment of the RT unit");
  }
}

void RtEngine::back_from_shader(Cycles now, std::uint32_t slot, std::uint32_t l) {
  Slot& s = slots_[slot];
  s.judging = --s.away > 0;
  account_series(now);
  account(now);
  set_state(now, s.lanes[l], LaneState::kInUnit);
  run_lane(now, now, slot, l);
  if (s.used) {
    maybe_judge(now, slot);
  }
}

// What the unit does in a cycle without a request or a test.
RtReason RtEngine::reason() const {
  if (port_blocked_) {
    return RtReason::kMshrFull;
  }
  if (in_unit_ > 0) {
    return RtReason::kWaitMemory;
  }
  return in_shader_ > 0 ? RtReason::kWaitShader : RtReason::kIdle;
}

void RtEngine::account(Cycles now) {
  if (now > attribution_.booked()) {
    const std::uint64_t tests = testing_.take(now);
    attribution_.until(now, port_blocked_ ? 0 : tests, RtReason::kTest, reason());
  }
}

// Before what the series show changes.
void RtEngine::account_series(Cycles now) {
  if (now > series_until_) {
    occupancy_.add(series_until_, now, resident_);
    active_series_.add(series_until_, now, in_unit_ + in_shader_);
    series_until_ = now;
  }
}

void RtEngine::finish(Cycles end) {
  account_series(end);
  account(end);
  attribution_.check(end);
  counts_.port_cycles = port_.cycles_used();
  static_cast<LaneOpCounts&>(counts_) = compiler_.counts();
  std::uint64_t lanes = 0;
  for (const std::uint64_t c : counts_.lane_cycles) {
    lanes += c;
  }
  A2RT_CHECK(lanes == counts_.warp_cycles * kLanes, "lane-cycles differ from warp residence");
}

std::string RtEngine::dump() const {
  static constexpr const char* kStates[] = {"no ray", "test", "candidate", "at the shader", "done"};
  std::string text = "rt[" + std::to_string(index_) + "]: " + std::to_string(resident_) + "/" +
                     std::to_string(slots_.size()) + " warps, port " +
                     (port_blocked_  ? "blocked by MSHRs"
                      : port_booked_ ? "booked"
                                     : "idle") +
                     "\n";
  for (const Slot& slot : slots_) {
    if (!slot.used) {
      continue;
    }
    text += "  warp " + std::to_string(slot.warp) + " since cycle " +
            std::to_string(slot.arrived.value) + ":";
    std::array<std::uint32_t, std::size(kStates)> states{};
    std::uint32_t fetching = 0;
    for (const Lane& lane : slot.lanes) {
      ++(lane.missing > 0 ? fetching : states[static_cast<std::size_t>(lane.state)]);
    }
    text += " " + std::to_string(fetching) + " fetch";
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (states[i] > 0) {
        text += " " + std::to_string(states[i]) + " " + kStates[i];
      }
    }
    text += ", " + std::to_string(slot.requests.live()) + " lines under way\n";
  }
  return text;
}

void RtEngine::check_drained() const {
  A2RT_CHECK(resident_ == 0 && stores_head_ == stores_.size() && in_unit_ == 0 && in_shader_ == 0,
             "the RT unit is not empty: " + dump());
}

}  // namespace a2rt::timing
