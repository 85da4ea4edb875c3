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

constexpr Cycles kTestsAhead{128}, kTestsFarAhead{1024};

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
      reserves_(config.model == Model::kReserved),
      compiler_(config.rt),
      compiled_(source.compiled(config.rt)) {
  A2RT_CHECK(slots_.size() <= Arrival::kReceivers,
             "an RT unit has more places for warps than arrivals can tell apart");
  if (reserves_) {
    calendar.number(*this, kLaneAhead, static_cast<std::uint32_t>(slots_.size()) * kLanes);
  }
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    slots_[i].index = static_cast<std::uint32_t>(i);
  }
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
  account(now);
  Slot& slot = *std::find_if(slots_.begin(), slots_.end(), [](const Slot& s) { return !s.used; });
  slot.used = true;
  slot.rank = resident_;
  slot.judging = false;
  slot.warp = warp;
  slot.active = slot.suspended = slot.away = 0;
  slot.requests.clear();
  by_age_.push_back(&slot);
  slot.arrived = now;
  ++resident_;
  ++counts_.warps;
  compile(now, slot, rays);
  A2RT_CHECK(slot.active > 0, "a warp without rays was sent to the RT unit");
  for (std::uint32_t l = 0; l < kLanes; ++l) {
    if (rays[l] != kNone) {
      set_state(now, slot.lanes[l], LaneState::kInUnit);
      run_lane(now, now, slot, l);
    }
  }
}

void RtEngine::compile(Cycles now, Slot& slot, const LaneRays& rays) {
  for (const std::uint32_t ray : rays) {
    if (ray != kNone) {
      prefetch_ray(ray);
    }
  }
  std::array<std::size_t, kLanes> first{};
  slot.ops.clear();
  for (std::uint32_t l = 0; l < kLanes; ++l) {
    slot.lanes[l] = {};
    slot.lanes[l].started = now;
    first[l] = slot.ops.size();
    if (rays[l] != kNone) {
      slot.lanes[l].op = compile_ray(rays[l], spill_memory(slot, l), slot.ops);
      ++slot.active;
      ++counts_.rays;
    }
  }
  for (std::uint32_t l = 0; l < kLanes; ++l) {
    if (slot.lanes[l].op == nullptr) {
      slot.lanes[l].op = slot.ops.data() + first[l];
    }
  }
}

void RtEngine::prefetch_ray(std::uint32_t ray) const {
  if (compiled_ != nullptr && compiled_->find(ray).ops != nullptr) {
    compiled_->prefetch(compiled_->find(ray));
  } else {
    source_.prefetch(ray);
  }
}

// The ray's operations where they are kept; or nullptr, and they are appended to `ops`.
const LaneOp* RtEngine::compile_ray(std::uint32_t ray, Address spill, LaneOps& ops) {
  if (compiled_ == nullptr) {
    compile_events(ray, spill, ops);
    return nullptr;
  }
  const CompiledRays::Ray& kept = compiled_->find(ray);
  if (kept.ops == nullptr) {
    const LaneOpCounts before = compiler_.counts();
    const std::size_t first = ops.size();
    compile_events(ray, spill, ops);
    compiled_->keep(ray, ops.data() + first, ops.size() - first, spill, before, compiler_.counts());
    return nullptr;
  }
  compiler_.count_again(kept.counts());
  if (!kept.spills) {
    return kept.ops;
  }
  for (std::uint32_t i = 0; i < kept.size; ++i) {
    const LaneOp op = kept.ops[i];
    ops.push_back(op.names_spill_memory() ? op.moved(Address{0}, spill) : op);
  }
  return nullptr;
}

void RtEngine::compile_events(std::uint32_t ray, Address spill, LaneOps& ops) {
  compiler_.begin(spill, ops);
  source_.events(ray, compiler_);
  compiler_.end();
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

A2RT_INLINE void RtEngine::appoint(Cycles now, Cycles at, Slot& slot, std::uint32_t l) {
  if (reserves_) {
    calendar_.at(at, slot.index * kLanes + l);
    return;
  }
  if (at.value - now.value >= kNear) [[unlikely]] {
    calendar_.at(at, *this, kLane, slot.index * kLanes + l);
    return;
  }
  const auto near = static_cast<std::uint32_t>(at.value % kNear);
  std::uint32_t& lanes = slot.wake_at[near];
  if (lanes == 0) {
    calendar_.at(at, *this, kNearLanes, slot.index * kNear + near);
  }
  lanes |= 1u << l;
}

void RtEngine::fail_without(Tester tester) const {
  throw UserError("the RT unit needs a tester that the machine does not have: set rt.testers." +
                  std::string(tester_name(tester)) + ".count above 0");
}

A2RT_INLINE Cycles RtEngine::issue(Cycles now, Cycles at, Tester tester, std::uint32_t count) {
  TesterPool& pool = pools_[static_cast<std::size_t>(tester)];
  if (!pool.exists()) [[unlikely]] {
    fail_without(tester);
  }
  return pool.issue(now, at, count);
}

// Reserves the testers of the tests that follow. Returns when the lane is through with them.
A2RT_INLINE Cycles RtEngine::run_tests(Cycles now, Cycles at, Lane& lane) {
  const Cycles start = at;
  // Who comes first in time should be first served, so what is far ahead is worked out later.
  const Cycles horizon = now + (reserves_ ? kTestsFarAhead : kTestsAhead);
  const LaneOp* next = lane.op;
  for (; next->is_test() && at < horizon; ++next) {
    if (next->code() == LaneOp::Code::kTest) [[likely]] {
      at = issue(now, at, next->tester(), next->count());
    } else {
      at = std::max(issue(now, at, Tester::kBox, next->count()),
                    issue(now, at, Tester::kQBox, next->second()));
    }
  }
  lane.op = next;
  lane_cycles(LaneReason::kTest) += at.value - start.value;
  testing_.mark(start, at);
  return at;
}

void RtEngine::run_lane(Cycles now, Cycles at, Slot& slot, std::uint32_t l) {
  Lane& lane = slot.lanes[l];
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
        reserves_ ? read_ahead(now, slot, l, op) : read(now, slot, l, op);
        return;
      case LaneOp::Code::kStore:
        if (reserves_) {
          store_ahead(now, op);
          break;
        }
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

A2RT_INLINE void RtEngine::read(Cycles now, Slot& slot, std::uint32_t l, LaneOp op) {
  Lane& lane = slot.lanes[l];
  const LaneOp* next = lane.op;
  std::uint32_t missing = 0;
  Cycles ready = now;
  while (true) {
    missing += slot.requests.add(now, l, op.line(), op.sectors(), op.kind(), ready);
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
    update_asking(slot);
    kick_port(now);
    return;
  }
  // All of it is on its way to another lane already.
  lane_cycles(LaneReason::kFetch) += ready.value - now.value;
  appoint(now, ready, slot, l);
}

void RtEngine::suspend(Cycles now, Slot& slot, std::uint32_t l, LaneOp op) {
  Lane& lane = slot.lanes[l];
  lane.ordinal = static_cast<std::uint16_t>(op.count());
  lane.intersection = op.code() == LaneOp::Code::kIntersection;
  account(now);
  set_state(now, lane, LaneState::kCandidate);
  ++slot.suspended;
  maybe_judge(now, slot);
}

void RtEngine::maybe_judge(Cycles now, Slot& slot) {
  if (slot.judging || slot.suspended == 0) {
    return;
  }
  const std::uint32_t threshold = config_.rt.callback_lanes;
  const bool enough = threshold > 0 && slot.suspended >= threshold;
  if (!enough && slot.active > slot.suspended) {
    return;
  }
  slot.jobs.clear();
  for (std::uint32_t l = 0; l < kLanes; ++l) {
    if (slot.lanes[l].state == LaneState::kCandidate) {
      set_state(now, slot.lanes[l], LaneState::kAtShader);
      slot.jobs.push_back({l, slot.lanes[l].ordinal, slot.lanes[l].intersection});
    }
  }
  slot.away = slot.suspended;
  slot.suspended = 0;
  slot.judging = true;
  ++counts_.round_trips;
  counts_.candidates += slot.jobs.size();
  host_.judge(now + config_.rt.callback_latency, slot.warp, slot.jobs);
}

void RtEngine::candidates_done(Cycles now, std::uint32_t warp) {
  const auto slot =
      std::find_if(by_age_.begin(), by_age_.end(), [&](const Slot* s) { return s->warp == warp; });
  A2RT_CHECK(slot != by_age_.end() && (*slot)->judging,
             "shaders answered for a warp that had not asked");
  for (const CandidateJob& job : (*slot)->jobs) {
    calendar_.at(now + config_.rt.callback_latency, *this, kLane,
                 (*slot)->index * kLanes + job.lane);
  }
}

void RtEngine::end_ray(Cycles now, Slot& slot, std::uint32_t l) {
  account(now);
  set_state(now, slot.lanes[l], LaneState::kDone);
  host_.ray_time(slot.warp, l, now - slot.lanes[l].started);
  if (--slot.active == 0) {
    end_warp(now, slot);
  } else {
    maybe_judge(now, slot);
  }
}

void RtEngine::end_warp(Cycles now, Slot& slot) {
  A2RT_CHECK(slot.requests.live() == 0, "a warp ended with requests under way");
  std::uint32_t inactive = 0;
  for (Lane& lane : slot.lanes) {
    if (lane.state == LaneState::kDone) {
      set_state(now, lane, LaneState::kNone);
    } else {
      ++inactive;
    }
  }
  const Cycles residence = now - slot.arrived;
  counts_.lane_cycles[static_cast<std::size_t>(LaneReason::kInactive)] +=
      inactive * residence.value;
  counts_.warp_cycles += residence.value;
  slot.used = false;
  forget_rank(slot.rank);
  --resident_;
  host_.rays_done(now, slot.warp, now + config_.rt.return_latency);
  host_.slot_free(now);
}

// Those behind it move up.
void RtEngine::forget_rank(std::uint32_t rank) {
  by_age_.erase(by_age_.begin() + rank);
  for (std::size_t r = rank; r < by_age_.size(); ++r) {
    by_age_[r]->rank = static_cast<std::uint32_t>(r);
  }
  const std::uint64_t older = (std::uint64_t{1} << rank) - 1;
  asking_ = (asking_ & older) | (asking_ >> 1 & ~older);
}

void RtEngine::wake(Cycles now, std::uint32_t what, std::uint32_t value) {
  calendar_.progress();
  switch (what) {
    case kNearLanes: {
      Slot& slot = slots_[value / kNear];
      std::uint32_t lanes = std::exchange(slot.wake_at[value % kNear], 0);
      for (; lanes != 0; lanes &= lanes - 1) {
        const auto l = static_cast<std::uint32_t>(std::countr_zero(lanes));
        Lane& lane = slot.lanes[l];
        if (lane.op->code() == LaneOp::Code::kRead) [[likely]] {
          read(now, slot, l, *lane.op++);
        } else {
          run_lane(now, now, slot, l);
        }
      }
      return;
    }
    case kLaneAhead:
      go_on_ahead(now, slots_[value / kLanes], value % kLanes);
      return;
    case kPort:
      run_port(now);
      return;
    case kLane: {
      Slot& slot = slots_[value / kLanes];
      const std::uint32_t l = value % kLanes;
      if (slot.lanes[l].state == LaneState::kAtShader) {
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

void RtEngine::back_from_shader(Cycles now, Slot& slot, std::uint32_t l) {
  slot.judging = --slot.away > 0;
  account(now);
  set_state(now, slot.lanes[l], LaneState::kInUnit);
  run_lane(now, now, slot, l);
  if (slot.used) {
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

void RtEngine::account_cycles(Cycles now) {
  if (now > attribution_.booked()) {
    std::uint64_t tests = 0;
    if (reserves_) {
      tests = testing_.take_without(now, sending_);
      book_port(now);
      attribution_.until(attribution_.booked() + Cycles{sending_.take(now)}, RtReason::kFetch);
    } else {
      tests = testing_.take(now);
    }
    attribution_.until(now, port_blocked_ ? 0 : tests, RtReason::kTest, reason());
  }
}

// Before the unit's warps and lanes change.
void RtEngine::account(Cycles now) {
  account_cycles(now);
  if (now > series_until_) {
    occupancy_.add(series_until_, now, resident_);
    active_series_.add(series_until_, now, in_unit_ + in_shader_);
    series_until_ = now;
  }
}

void RtEngine::finish(Cycles end) {
  account(end);
  attribution_.check(end);
  port_series_.add(end, end, 0);  // all units' series have the same bins
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
