// Warp buffer and ray state machines; the port is in rt_engine_port.cpp.
#include "a2rt/timing/rt_engine.h"

#include <algorithm>
#include <bit>

namespace a2rt::timing {
namespace {

// The part of a GPU-wide count that unit `index` of `units` gets, spread evenly.
std::uint32_t share(std::uint32_t total, std::uint32_t index, std::uint32_t units) {
  return total / units + (index < total % units ? 1 : 0);
}

}  // namespace

RtEngine::RtEngine(const MachineConfig& config, std::uint32_t index, Calendar& calendar,
                   L1Cache& l1, RaySource& source, RtHost& host)
    : config_(config),
      index_(index),
      calendar_(calendar),
      l1_(l1),
      source_(source),
      host_(host),
      clock_(config.rt.mhz, config.core_mhz),
      port_(config.rt.port_sectors) {
  for (std::size_t t = 0; t < kTesters; ++t) {
    const TesterConfig& c = config.rt.testers[t];
    std::uint32_t count = share(c.count, index, config.sm.count);
    if (c.count > 0 && count == 0) {
      throw UserError("rt.testers." + std::string(tester_name(static_cast<Tester>(t))) +
                      ".count = " + std::to_string(c.count) +
                      " leaves an RT unit without one; use 0 or at least " +
                      std::to_string(config.sm.count));
    }
    pools_[t] = TesterPool(count, c.latency, c.interval, clock_);
  }
  for (std::uint32_t i = 0; i < config.rt.warps; ++i) {
    slots_.push_back(std::make_unique<Slot>());
  }
}

void RtEngine::accept(Cycles now, std::uint32_t warp, const LaneRays& rays) {
  A2RT_CHECK(has_room(), "the RT unit was given a warp without having room");
  account(now);
  std::uint32_t index = 0;
  while (slots_[index]->used) {
    ++index;
  }
  Slot& slot = *slots_[index];
  slot.used = true;
  slot.judging = false;
  slot.warp = warp;
  slot.active = slot.suspended = slot.away = 0;
  by_age_.push_back(index);
  slot.arrived = now;
  ++resident_;
  ++counts_.warps;
  for (std::uint32_t l = 0; l < kLanes; ++l) {
    Lane& lane = slot.lanes[l];
    lane = {};
    lane.since = lane.started = now;
    lane.ray = rays[l];
    slot.events[l].clear();
    if (rays[l] != kNone) {
      source_.events(rays[l], slot.events[l]);
      ++slot.active;
      ++counts_.rays;
    }
  }
  A2RT_CHECK(slot.active > 0, "a warp without rays was sent to the RT unit");
  for (std::uint32_t l = 0; l < kLanes; ++l) {
    if (rays[l] != kNone) {
      run_lane(now, index, l);
    }
  }
}

void RtEngine::set_state(Cycles now, Lane& lane, LaneState state) {
  account(now);
  const std::uint64_t spent = now.value - lane.since.value;
  lane.since = now;
  const auto book = [&](LaneReason r) {
    counts_.lane_cycles[static_cast<std::size_t>(r)] += spent;
  };
  switch (lane.state) {
    case LaneState::kFetch:
      book(LaneReason::kFetch);
      --in_fetch_;
      break;
    case LaneState::kTest:
      book(LaneReason::kTest);
      --in_test_;
      break;
    case LaneState::kCandidate:
    case LaneState::kAtShader:
      book(LaneReason::kShader);
      --in_shader_;
      break;
    case LaneState::kDone:
      book(LaneReason::kDone);
      break;
    case LaneState::kNone:
      A2RT_CHECK(spent == 0, "a lane spent time in no state");
      break;
  }
  lane.state = state;
  in_fetch_ += state == LaneState::kFetch;
  in_test_ += state == LaneState::kTest;
  in_shader_ += state == LaneState::kCandidate || state == LaneState::kAtShader;
}

void RtEngine::run_lane(Cycles now, std::uint32_t slot, std::uint32_t l) {
  calendar_.progress();
  Lane& lane = slots_[slot]->lanes[l];
  const std::vector<Event>& events = slots_[slot]->events[l];
  while (true) {
    if (lane.step < lane.steps) {
      const Step step = lane.step_list[lane.step++];
      test(now, slot, l, step.tester, step.count);
      return;
    }
    lane.step = lane.steps = 0;
    if (lane.cursor == events.size()) {
      end_ray(now, slot, l);
      return;
    }
    const Event& event = events[lane.cursor++];
    ++counts_.events[static_cast<std::size_t>(event.kind)];
    if (do_event(now, slot, l, event)) {
      return;
    }
  }
}

bool RtEngine::do_event(Cycles now, std::uint32_t slot, std::uint32_t l, const Event& event) {
  switch (event.kind) {
    case EventKind::kFetch:
      return fetch(now, slot, l, Address{event.address}, event.bytes, event.traffic);
    case EventKind::kBoxTest:
      return test_node(now, slot, l, event.count);
    case EventKind::kQBoxTest:
      return test(now, slot, l, Tester::kQBox, event.count);
    case EventKind::kTriangleTest:
      return test(now, slot, l, Tester::kTriangle, event.count);
    case EventKind::kRaySetup:
      return test(now, slot, l, Tester::kSetup, event.count);
    case EventKind::kQuantizeRay:
      return test(now, slot, l, Tester::kQuantizer, event.count);
    case EventKind::kAnchorTest:
      return test(now, slot, l, Tester::kAnchor, event.count);
    case EventKind::kUpdate:
      return test(now, slot, l, Tester::kUpdate, event.count);
    case EventKind::kDequantize:
      return test(now, slot, l, Tester::kDequantize, event.count);
    case EventKind::kTransform:
      return test(now, slot, l, Tester::kTransform, event.count);
    case EventKind::kEscape:
      return false;  // the unit emits the dequantizations and FP32 tests that it causes
    case EventKind::kPush:
      push(now, slot, l, event.count);
      return false;
    case EventKind::kPop:
      return pop(now, slot, l, event.count);
    case EventKind::kContextPush:
      push_context(now, slot, l);
      return false;
    case EventKind::kContextPop:
      return pop_context(now, slot, l, event);
    case EventKind::kAnyHit:
    case EventKind::kIntersection:
      return suspend(now, slot, l, event);
    case EventKind::kCount:
      break;
  }
  A2RT_CHECK(false, "a ray emitted an event of unknown kind");
  return false;
}

void RtEngine::follow(Lane& lane, Step first, Step second) {
  lane.step_list = {first, second};
  lane.step = 0;
  lane.steps = second.count > 0 ? 2 : 1;
}

bool RtEngine::fetch(Cycles now, std::uint32_t slot, std::uint32_t l, Address address,
                     std::uint32_t bytes, Traffic kind) {
  A2RT_CHECK(bytes > 0, "a ray fetches 0 bytes");
  Slot& s = *slots_[slot];
  Lane& lane = s.lanes[l];
  lane.missing = want(s, l, address, bytes, kind);
  // A contiguous range of records of several kinds is one read of the unit.
  const std::vector<Event>& events = s.events[l];
  std::uint64_t end = address.value + bytes;
  while (lane.cursor < events.size() && events[lane.cursor].kind == EventKind::kFetch &&
         events[lane.cursor].address == end) {
    const Event& more = events[lane.cursor++];
    ++counts_.events[static_cast<std::size_t>(EventKind::kFetch)];
    lane.missing += want(s, l, Address{more.address}, more.bytes, more.traffic);
    end += more.bytes;
  }
  set_state(now, lane, LaneState::kFetch);
  kick_port(now);
  return true;
}

std::uint32_t RtEngine::want(Slot& slot, std::uint32_t l, Address address, std::uint32_t bytes,
                             Traffic kind) {
  const std::uint32_t sectors = slot.requests.add(l, address, bytes, kind);
  const auto k = static_cast<std::size_t>(kind);
  ++counts_.fetches[k];
  counts_.fetch_bytes[k] += bytes;
  counts_.sectors_wanted[k] += sectors;
  return sectors;
}

bool RtEngine::test(Cycles now, std::uint32_t slot, std::uint32_t l, Tester tester,
                    std::uint32_t count) {
  if (count == 0) {
    return false;
  }
  TesterPool& pool = pool_for(tester);
  set_state(now, slots_[slot]->lanes[l], LaneState::kTest);
  calendar_.at(pool.issue(now, count), *this, kLane, slot * kLanes + l);
  return true;
}

// FP32 and quantized boxes of one node do not depend on each other: both pools start at once.
bool RtEngine::test_node(Cycles now, std::uint32_t slot, std::uint32_t l, std::uint32_t boxes) {
  Lane& lane = slots_[slot]->lanes[l];
  const std::vector<Event>& events = slots_[slot]->events[l];
  if (lane.cursor == events.size() || events[lane.cursor].kind != EventKind::kQBoxTest) {
    return test(now, slot, l, Tester::kBox, boxes);
  }
  const std::uint32_t qboxes = events[lane.cursor++].count;
  ++counts_.events[static_cast<std::size_t>(EventKind::kQBoxTest)];
  set_state(now, lane, LaneState::kTest);
  const Cycles end = std::max(pool_for(Tester::kBox).issue(now, boxes),
                              pool_for(Tester::kQBox).issue(now, qboxes));
  calendar_.at(end, *this, kLane, slot * kLanes + l);
  return true;
}

TesterPool& RtEngine::pool_for(Tester tester) {
  TesterPool& pool = pools_[static_cast<std::size_t>(tester)];
  if (!pool.exists()) {
    throw UserError("the RT unit needs a tester that the machine does not have: set rt.testers." +
                    std::string(tester_name(tester)) + ".count above 0");
  }
  return pool;
}

bool RtEngine::suspend(Cycles now, std::uint32_t slot, std::uint32_t l, const Event& event) {
  Slot& s = *slots_[slot];
  Lane& lane = s.lanes[l];
  lane.ordinal = event.count;
  lane.intersection = event.kind == EventKind::kIntersection;
  set_state(now, lane, LaneState::kCandidate);
  ++s.suspended;
  maybe_judge(now, slot);
  return true;
}

void RtEngine::maybe_judge(Cycles now, std::uint32_t slot) {
  Slot& s = *slots_[slot];
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
  while (slot < slots_.size() && !(slots_[slot]->used && slots_[slot]->warp == warp)) {
    ++slot;
  }
  A2RT_CHECK(slot < slots_.size() && slots_[slot]->judging,
             "shaders answered for a warp that had not asked");
  Slot& s = *slots_[slot];
  for (const CandidateJob& job : s.jobs) {
    calendar_.at(now + config_.rt.callback_latency, *this, kLane, slot * kLanes + job.lane);
  }
}

void RtEngine::end_ray(Cycles now, std::uint32_t slot, std::uint32_t l) {
  Slot& s = *slots_[slot];
  set_state(now, s.lanes[l], LaneState::kDone);
  host_.ray_time(s.lanes[l].ray, now - s.lanes[l].started);
  if (--s.active > 0) {
    maybe_judge(now, slot);
    return;
  }
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
  std::erase(by_age_, slot);
  --resident_;
  host_.rays_done(now, s.warp, now + config_.rt.return_latency);
  host_.slot_free(now);
}

void RtEngine::wake(Cycles now, std::uint32_t what, std::uint32_t value) {
  switch (what) {
    case kL1Data:
      data(now, value);
      return;
    case kL1Unblocked:
      account(now);
      port_blocked_ = false;
      kick_port(now);
      return;
    case kPort:
      run_port(now);
      return;
    case kLane: {
      Slot& slot = *slots_[value / kLanes];
      if (slot.lanes[value % kLanes].state != LaneState::kAtShader) {
        run_lane(now, value / kLanes, value % kLanes);
        return;
      }
      slot.judging = --slot.away > 0;
      run_lane(now, value / kLanes, value % kLanes);
      if (slot.used) {
        maybe_judge(now, value / kLanes);
      }
      return;
    }
    default:
      A2RT_CHECK(false, "unknown appointment of the RT unit");
  }
}

RtReason RtEngine::reason() const {
  if (port_blocked_) {
    return RtReason::kMshrFull;
  }
  if (in_test_ > 0) {
    return RtReason::kTest;
  }
  if (in_fetch_ > 0) {
    return RtReason::kWaitMemory;
  }
  return in_shader_ > 0 ? RtReason::kWaitShader : RtReason::kIdle;
}

void RtEngine::account(Cycles now) {
  if (now > attribution_.booked()) {
    attribution_.until(now, reason());
  }
  if (now > series_until_) {
    occupancy_.add(series_until_, now, resident_);
    active_series_.add(series_until_, now, in_fetch_ + in_test_ + in_shader_);
    series_until_ = now;
  }
}

void RtEngine::finish(Cycles end) {
  account(end);
  attribution_.check(end);
  std::uint64_t lanes = 0;
  for (const std::uint64_t c : counts_.lane_cycles) {
    lanes += c;
  }
  A2RT_CHECK(lanes == counts_.warp_cycles * kLanes, "lane-cycles differ from warp residence");
}

std::string RtEngine::dump() const {
  static constexpr const char* kStates[] = {"no ray",    "fetch",         "test",
                                            "candidate", "at the shader", "done"};
  std::string text = "rt[" + std::to_string(index_) + "]: " + std::to_string(resident_) + "/" +
                     std::to_string(slots_.size()) + " warps, port " +
                     (port_blocked_  ? "blocked by MSHRs"
                      : port_booked_ ? "booked"
                                     : "idle") +
                     "\n";
  for (const auto& slot : slots_) {
    if (!slot->used) {
      continue;
    }
    text += "  warp " + std::to_string(slot->warp) + " since cycle " +
            std::to_string(slot->arrived.value) + ":";
    std::array<std::uint32_t, 6> states{};
    for (const Lane& lane : slot->lanes) {
      ++states[static_cast<std::size_t>(lane.state)];
    }
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (states[i] > 0) {
        text += " " + std::to_string(states[i]) + " " + kStates[i];
      }
    }
    text += ", " + std::to_string(slot->requests.live()) + " lines under way\n";
  }
  return text;
}

void RtEngine::check_drained() const {
  A2RT_CHECK(resident_ == 0 && stores_head_ == stores_.size() && in_fetch_ == 0 && in_test_ == 0 &&
                 in_shader_ == 0,
             "the RT unit is not empty: " + dump());
}

}  // namespace a2rt::timing
