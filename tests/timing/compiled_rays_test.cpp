// A run on rays that an earlier one has compiled is the run that traverses them.
#include "a2rt/timing/compiled_rays.h"

#include <gtest/gtest.h>

#include "mocks.h"

namespace a2rt::timing::test {
namespace {

// Counts the rays that are traversed.
class CountedSource final : public RaySource {
 public:
  void events(std::uint32_t ray, EventReceiver& to) override {
    ++traversed;
    rays_.events(ray, to);
  }
  std::size_t traversed = 0;

 private:
  NoisySource rays_;
};

void expect_equal(const SimulationResult& a, const SimulationResult& b) {
  EXPECT_EQ(a.cycles, b.cycles);
  EXPECT_EQ(a.launch_cycles, b.launch_cycles);
  EXPECT_EQ(a.l1.hits, b.l1.hits);
  EXPECT_EQ(a.l2.hits, b.l2.hits);
  EXPECT_EQ(a.dram.row_hits, b.dram.row_hits);
  EXPECT_EQ(a.rt_reasons, b.rt_reasons);
  EXPECT_EQ(a.appointments, b.appointments);
  EXPECT_EQ(LaneOpCounts::as_numbers(a.rt), LaneOpCounts::as_numbers(b.rt));
}

struct Repeated : InBothModels {
  // Three runs: without keeping, the one that keeps the rays, the one that knows them.
  static void check(const MachineConfig& config) {
    const Workload w = rays_only(1024, 2, 64);
    NoisySource plain;
    CountedSource source;
    RepeatedRays uut(source, w.rays.size());
    const SimulationResult want = simulate(w, plain, config);
    expect_equal(simulate(w, uut, config), want);
    EXPECT_EQ(source.traversed, w.rays.size());
    expect_equal(simulate(w, uut, config), want);
    EXPECT_EQ(source.traversed, w.rays.size()) << "a known ray was traversed again";
  }
  static MachineConfig machine() {
    MachineConfig config;
    config.model = GetParam();
    return config;
  }
};

TEST_P(Repeated, known_rays_give_the_same_run) { check(machine()); }

TEST_P(Repeated, spilled_entries_lie_in_the_memory_of_the_lane_that_traces_the_ray) {
  MachineConfig config = machine();
  config.rt.stack_entries = 2;
  check(config);
  // Other lanes than those that compiled the rays.
  const Workload w = rays_only(1024, 2, 64);
  NoisySource plain;
  CountedSource source;
  RepeatedRays uut(source, w.rays.size());
  simulate(w, uut, config);
  config.sm.count = 3;
  config.rt.warps = 7;
  const SimulationResult want = simulate(w, plain, config);
  EXPECT_GT(want.rt.stack_spills, 0u);
  expect_equal(simulate(w, uut, config), want);
  EXPECT_EQ(source.traversed, w.rays.size());
}

TEST_P(Repeated, another_short_stack_has_its_rays_compiled_again) {
  const Workload w = rays_only(256, 1, 64);
  NoisySource plain;
  CountedSource source;
  RepeatedRays uut(source, w.rays.size());
  MachineConfig config = machine();
  simulate(w, uut, config);
  config.rt.stack_entries = 3;
  expect_equal(simulate(w, uut, config), simulate(w, plain, config));
  EXPECT_EQ(source.traversed, 2 * w.rays.size());
}

TEST_P(Repeated, rays_without_room_are_traversed_each_time) {
  const Workload w = rays_only(16384, 1, 64);
  NoisySource plain;
  const SimulationResult want = simulate(w, plain, machine());
  for (const Bytes room : {Bytes{0}, Bytes{1 << 23}}) {
    CountedSource source;
    RepeatedRays uut(source, w.rays.size(), room);
    simulate(w, uut, machine());
    const std::size_t kept = uut.compiled(machine().rt)->kept();
    EXPECT_EQ(kept > 0, room.value > 0);
    EXPECT_LT(kept, w.rays.size());
    expect_equal(simulate(w, uut, machine()), want);
    EXPECT_EQ(source.traversed, 2 * w.rays.size() - kept);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Repeated, kBothModels, model_name);

TEST(CompiledRays, a_ray_of_more_than_its_record_can_count_is_not_kept) {
  CompiledRays uut({}, 2, RepeatedRays::kMost);
  const LaneOp end = LaneOp::counted(LaneOp::Code::kEnd, 0);
  LaneOpCounts before, after;
  before.context_refetch_steps = 7;
  after.context_refetch_steps = 7 + LaneOpCount::kMost + 1;
  uut.keep(0, &end, 1, Address{0}, before, after);
  EXPECT_EQ(uut.find(0).ops, nullptr);
  --after.context_refetch_steps;
  uut.keep(1, &end, 1, Address{0}, before, after);
  ASSERT_NE(uut.find(1).ops, nullptr);
  ASSERT_EQ(uut.find(1).counts().size(), 1u);
  EXPECT_EQ(uut.find(1).counts()[0].index(), LaneOpCounts::kNumbers - 1);
  EXPECT_EQ(uut.find(1).counts()[0].value(), LaneOpCount::kMost);
}

}  // namespace
}  // namespace a2rt::timing::test
