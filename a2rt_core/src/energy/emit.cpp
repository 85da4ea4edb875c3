// Which hardware each count of a run stands for.
#include "a2rt/capture/records.h"
#include "a2rt/energy/ledger.h"

namespace a2rt::energy {
namespace {

using timing::SimulationResult;
using timing::Tester;

// The quantized tester of a design; FP32 designs have none.
const char* qbox_of(Design design) { return design == Design::kAqb8 ? "qbox_aqb8" : "qbox_a2rt"; }

std::uint64_t sum(const timing::TrafficCounts& counts) {
  std::uint64_t total = 0;
  for (const std::uint64_t c : counts) {
    total += c;
  }
  return total;
}

void testers(const SimulationResult& r, Design design, std::vector<Action>& out) {
  const auto tests = [&](Tester t) { return r.testers[static_cast<std::size_t>(t)].tests; };
  out.push_back({"box", "test", tests(Tester::kBox)});
  out.push_back({qbox_of(design), "test", tests(Tester::kQBox)});
  out.push_back({"quantizer", "quantize", tests(Tester::kQuantizer)});
  out.push_back({"anchor", "test", tests(Tester::kAnchor)});
  out.push_back({"update", "update", tests(Tester::kUpdate)});
  out.push_back({"triangle", "test", tests(Tester::kTriangle)});
  out.push_back({"transform", "transform", tests(Tester::kTransform)});
  out.push_back({"setup", "reciprocal", tests(Tester::kSetup)});
  out.push_back({"dequantizer", "box", tests(Tester::kDequantize)});
}

// Small memories of the RT unit: a ray's record is read for every step it takes, those of setting
// up a refetched context included. What moves between stack or context buffer and memory goes
// through the buffer once more.
void rt_buffers(const SimulationResult& r, std::vector<Action>& out) {
  const auto events = [&](EventKind k) { return r.rt.events[static_cast<std::size_t>(k)]; };
  const std::uint64_t full = events(EventKind::kBoxTest) + events(EventKind::kTriangleTest) +
                             events(EventKind::kAnchorTest) + events(EventKind::kQuantizeRay) +
                             events(EventKind::kTransform) + events(EventKind::kRaySetup) +
                             events(EventKind::kUpdate) + r.rt.context_refetch_steps;
  out.push_back({"ray_buffer", "read_fp32", full});
  out.push_back({"ray_buffer", "read_quantized", events(EventKind::kQBoxTest)});
  out.push_back({"rt_stack", "push", r.rt.stack_pushed + r.rt.stack_filled});
  out.push_back({"rt_stack", "pop", r.rt.stack_popped + r.rt.stack_spilled});
  out.push_back({"rt_context", "push", r.rt.context_saves + r.rt.context_fills});
  out.push_back({"rt_context", "pop", r.rt.context_restores + r.rt.context_spills});
}

void memories(const SimulationResult& r, std::vector<Action>& out) {
  out.push_back({"l1", "read_sector", sum(r.l1.reads) + r.l1.written_back});
  out.push_back({"l1", "write_sector", sum(r.l1.writes) + r.l1.fills});
  out.push_back({"crossbar", "sector", r.crossbar_sectors});
  out.push_back({"l2", "read_sector", sum(r.l2.reads) + r.l2.written_back});
  out.push_back({"l2", "write_sector", sum(r.l2.writes) + r.l2.fills});
  out.push_back({"dram", "read_sector", r.dram.reads});
  out.push_back({"dram", "write_sector", r.dram.writes});
}

void shaders(const SimulationResult& r, std::vector<Action>& out) {
  using capture::Counter;
  const auto lanes = [&](Counter c) { return r.sm.lane_operations[static_cast<std::size_t>(c)]; };
  out.push_back({"sm", "issue", r.sm.instructions()});
  out.push_back({"sm", "alu", lanes(Counter::kAlu) + lanes(Counter::kControl)});
  out.push_back({"sm", "sfu", lanes(Counter::kSfu)});
  out.push_back({"sm", "uniform_word", lanes(Counter::kUniformLoad)});
  out.push_back({"sm", "memory_word",
                 lanes(Counter::kBufferLoad) + lanes(Counter::kBufferStore) +
                     lanes(Counter::kTexture) + lanes(Counter::kPayload)});
}

std::vector<Action> all_actions(const SimulationResult& result, Design design) {
  std::vector<Action> all;
  testers(result, design, all);
  rt_buffers(result, all);
  memories(result, all);
  shaders(result, all);
  return all;
}

}  // namespace

std::vector<Action> possible_actions() {
  std::vector<Action> all = all_actions({}, Design::kA2rt);
  all.push_back({qbox_of(Design::kAqb8), "test", 0});
  return all;
}

std::vector<Action> actions_of(const SimulationResult& result, Design design) {
  std::vector<Action> all = all_actions(result, design);
  std::erase_if(all, [](const Action& a) { return a.count == 0; });
  return all;
}

std::vector<Instances> instances_of(const SimulationResult& result,
                                    const timing::MachineConfig& config, Design design) {
  const std::uint64_t sms = config.sm.count;
  std::vector<Instances> all = {
      {"sm", sms},
      {"l1", sms},
      {"ray_buffer", sms},
      {"rt_stack", sms},
      {"l2", std::uint64_t{config.l2.channels} * config.l2.slices_per_channel},
      {"crossbar", 1},
      {"dram", config.l2.channels}};
  // Testers that the unit never uses are not part of its design.
  const auto add = [&](const char* component, Tester tester) {
    const timing::TesterUse& use = result.testers[static_cast<std::size_t>(tester)];
    if (use.tests > 0) {
      all.push_back({component, use.count});
    }
  };
  add("box", Tester::kBox);
  add(qbox_of(design), Tester::kQBox);
  add("quantizer", Tester::kQuantizer);
  add("anchor", Tester::kAnchor);
  add("update", Tester::kUpdate);
  add("triangle", Tester::kTriangle);
  add("transform", Tester::kTransform);
  add("setup", Tester::kSetup);
  add("dequantizer", Tester::kDequantize);
  const bool contexts = design == Design::kAqb8 || design == Design::kA2rt;
  if (contexts && config.rt.context == timing::ContextPolicy::kStack) {
    all.push_back({"rt_context", sms});
  }
  return all;
}

}  // namespace a2rt::energy
