// Neighbours for the component under test.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "a2rt/timing/calendar.h"
#include "a2rt/timing/l1_cache.h"
#include "a2rt/timing/machine_config.h"
#include "a2rt/timing/memory_port.h"
#include "a2rt/timing/ray_source.h"
#include "a2rt/timing/simulator.h"
#include "a2rt/workload/workload.h"

namespace a2rt::timing::test {

// Runs the calendar until it is empty; returns the last cycle.
inline Cycles drain(Calendar& calendar) {
  while (calendar.step()) {
  }
  return calendar.now();
}

// Notes when its sectors are ready, by token; the last sector counts.
class RecordingClient final : public L1Client {
 public:
  void arrived(Cycles, std::uint32_t token, SectorMask sectors, const SectorTimes& when) override {
    for_each_bit(sectors, [&](std::uint32_t s) { ready[token] = std::max(ready[token], when[s]); });
  }
  void unblocked(Cycles now) override { unblocked_at.push_back(now); }
  std::map<std::uint32_t, Cycles> ready;
  std::vector<Cycles> unblocked_at;
};

// Answers every read after a fixed time, or keeps it for ever.
class FixedLower final : public LowerLevel, public Component {
 public:
  FixedLower(Calendar& calendar, Cycles latency) : calendar_(calendar), latency_(latency) {}
  LineSink* sink = nullptr;
  bool hold = false;
  struct Seen {
    Cycles leaves;
    Address line;
    SectorMask sectors;
    bool write;
  };
  std::vector<Seen> seen;

  void request(Cycles leaves, std::uint32_t, Address line, SectorMask sectors, Traffic,
               bool write) override {
    seen.push_back({leaves, line, sectors, write});
    if (!write && !hold) {
      calendar_.at(leaves + latency_, *this, 0, static_cast<std::uint32_t>(seen.size() - 1));
    }
  }
  void wake(Cycles now, std::uint32_t, std::uint32_t value) override {
    sink->fill(now, seen[value].line, seen[value].sectors);
  }
  std::string dump() const override { return "fixed lower level\n"; }
  void check_drained() const override {}

 private:
  Calendar& calendar_;
  Cycles latency_;
};

// Runs a function at a given cycle.
class At final : public Component {
 public:
  At(Calendar& calendar, Cycles when, std::function<void(Cycles)> what) : what_(std::move(what)) {
    calendar.at(when, *this, 0);
  }
  void wake(Cycles now, std::uint32_t, std::uint32_t) override { what_(now); }
  std::string dump() const override { return "scripted step\n"; }
  void check_drained() const override {}

 private:
  std::function<void(Cycles)> what_;
};

// Rays whose events are written down in the test; a ray without script has none.
class ScriptedSource final : public RaySource {
 public:
  std::map<std::uint32_t, std::vector<Event>> script;
  std::vector<Event> everyone;  // for rays not in `script`
  std::vector<std::uint32_t> order;
  void events(std::uint32_t ray, EventReceiver& out) override {
    order.push_back(ray);
    const auto it = script.find(ray);
    send(it == script.end() ? everyone : it->second, out);
  }
};

inline Event fetch(std::uint64_t address, std::uint32_t bytes = 32, Traffic kind = Traffic::kNode) {
  return {EventKind::kFetch, kind, 1, bytes, address};
}
inline Event count_event(EventKind kind, std::uint16_t count = 1) {
  return {kind, Traffic::kNone, count, 0, 0};
}

// Pseudo-random but repeatable events: fetches over 4 MB, node and triangle tests, a stack.
class NoisySource final : public RaySource {
 public:
  void events(std::uint32_t ray, EventReceiver& to) override {
    std::uint64_t s = ray * 0x9e3779b97f4a7c15u + 1;
    const auto next = [&] { return s = s * 6364136223846793005u + 1442695040888963407u, s >> 33; };
    std::vector<Event> out;
    const std::uint64_t steps = 4 + next() % 20;
    for (std::uint64_t i = 0; i < steps; ++i) {
      // One by one: compilers differ in the order of arguments.
      const auto bytes = static_cast<std::uint32_t>(56 + next() % 200);
      out.push_back(fetch(next() % (1 << 22) / 16 * 16, bytes));
      out.push_back(count_event(EventKind::kBoxTest, 6));
      out.push_back(count_event(EventKind::kPush, 3));
      if (next() % 3 == 0) {
        out.push_back(fetch((1 << 23) + next() % (1 << 20) * 36, 36, Traffic::kTriangle));
        out.push_back(count_event(EventKind::kTriangleTest));
      }
      out.push_back(count_event(EventKind::kPop));
    }
    send(out, to);
  }
};

// `launches` launch ids in rows of `width`, each with `rays` rays and no shader work.
inline Workload rays_only(std::uint32_t launches, std::uint32_t rays = 1, std::uint32_t width = 0) {
  Workload w;
  Dispatch d;
  d.width = width == 0 ? launches : width;
  d.height = launches == 0 ? 0 : launches / d.width;
  for (std::uint32_t l = 0; l < launches; ++l) {
    for (std::uint32_t r = 0; r < rays; ++r) {
      Ray ray;
      ray.launch = l;
      ray.ordinal = r;
      w.rays.push_back(ray);
    }
  }
  d.ray_count = w.rays.size();
  w.driver_hits.resize(w.rays.size());
  w.candidate_first.assign(w.rays.size() + 1, 0);
  w.dispatches.push_back(d);
  return w;
}

// A segment of `counts` by launch `launch` in `shader`, ending with `ray`.
inline Segment segment(std::uint32_t launch, std::uint32_t shader,
                       std::array<std::uint32_t, 8> counts, std::uint32_t ray = kNone) {
  return {launch, shader, counts, ray};
}

inline Shader shader(capture::Stage stage) {
  return {static_cast<std::uint32_t>(stage), 0, "main"};
}

// Shaders only: one dispatch of `width` launch ids without rays.
inline Workload shaders_only(std::uint32_t width, std::vector<Shader> shaders,
                             std::vector<Segment> segments) {
  Workload w;
  w.shaders = std::move(shaders);
  w.segments = std::move(segments);
  Dispatch d;
  d.width = width;
  d.height = 1;
  d.segment_count = w.segments.size();
  w.dispatches.push_back(d);
  w.candidate_first.assign(1, 0);
  return w;
}

// One SM, one RT unit, plenty of testers; a test narrows what it is about.
inline MachineConfig one_sm(Model model = Model::kQueued) {
  MachineConfig c;
  c.model = model;
  c.sm.count = 1;
  for (TesterConfig& t : c.rt.testers) {
    t = {256, Cycles{4}, Cycles{1}};
  }
  return c;
}

// What a run costs besides the rays' own time: the warp's return and its retirement.
inline Cycles overhead(const MachineConfig& c) { return c.rt.return_latency + Cycles{1}; }

inline Cycles cycles_of(const Workload& w, RaySource& source, const MachineConfig& config) {
  return simulate(w, source, config).cycles;
}

// Latency of a read that misses L1 and hits L2, both ports free.
inline Cycles l2_hit(const MachineConfig& c) {
  return c.l1.latency + c.l2.crossbar_latency * 2 + c.l2.latency;
}

// Closed forms hold in both models.
class InBothModels : public ::testing::TestWithParam<Model> {};
inline const auto kBothModels = ::testing::Values(Model::kQueued, Model::kReserved);
inline std::string model_name(const ::testing::TestParamInfo<Model>& info) {
  return info.param == Model::kQueued ? "queued" : "reserved";
}

}  // namespace a2rt::timing::test
