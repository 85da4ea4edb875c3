// The SM: arithmetic latency and overlap, GTO order, divergence, loads, launch of warps.
#include "a2rt/timing/sm.h"

#include <gtest/gtest.h>

#include "mocks.h"

namespace a2rt::timing::test {
namespace {

using capture::Stage;
std::array<std::uint32_t, 8> alu(std::uint32_t n) { return {n}; }
std::array<std::uint32_t, 8> sfu(std::uint32_t n) { return {0, n}; }
std::array<std::uint32_t, 8> loads(std::uint32_t words) { return {0, 0, 0, words}; }

struct SmTest : ::testing::Test {
  MachineConfig config = one_sm();
  ScriptedSource source;
  SmTest() {
    config.sm.schedulers = 1;
    config.sm.independent_instructions = 1;
  }
  SimulationResult run(const Workload& w) { return simulate(w, source, config); }
  // One raygen segment of `counts` for each of `launches` launch ids.
  Workload same(std::uint32_t launches, std::array<std::uint32_t, 8> counts) {
    std::vector<Segment> segments;
    for (std::uint32_t l = 0; l < launches; ++l) {
      segments.push_back(segment(l, 0, counts));
    }
    return shaders_only(launches, {shader(Stage::kRayGeneration)}, segments);
  }
  Cycles time(const Workload& w) { return run(w).cycles - Cycles{1}; }
};

TEST_F(SmTest, dependent_instructions_cost_one_latency_each) {
  EXPECT_EQ(time(same(1, alu(10))), config.sm.alu_latency * 10);
}

TEST_F(SmTest, independent_instructions_are_issued_back_to_back) {
  config.sm.independent_instructions = 5;
  // Two bursts of five: four more issues, then the latency of the last.
  EXPECT_EQ(time(same(1, alu(10))), (Cycles{4} + config.sm.alu_latency) * 2);
}

TEST_F(SmTest, a_full_warp_costs_what_one_lane_costs) {
  EXPECT_EQ(time(same(32, alu(10))), time(same(1, alu(10))));
}

TEST_F(SmTest, warps_hide_each_others_latency) {
  // Four warps of ten dependent instructions keep one scheduler busy every cycle.
  EXPECT_EQ(time(same(128, alu(10))), Cycles{39} + config.sm.alu_latency);
}

TEST_F(SmTest, schedulers_issue_in_parallel) {
  config.sm.schedulers = 4;
  EXPECT_EQ(time(same(128, alu(10))), config.sm.alu_latency * 10);
}

TEST_F(SmTest, sfu_instructions_are_an_interval_apart) {
  EXPECT_EQ(time(same(1, sfu(4))), config.sm.sfu_interval * 3 + config.sm.sfu_latency);
}

TEST_F(SmTest, a_warp_costs_the_maximum_over_its_lanes) {
  Workload w = same(2, alu(10));
  w.segments[1].counts[0] = 30;
  EXPECT_EQ(time(w), config.sm.alu_latency * 30);
}

TEST_F(SmTest, lanes_in_different_shaders_serialise) {
  const std::vector<Segment> segments = {segment(0, 0, alu(10)), segment(1, 1, alu(7))};
  const Workload w = shaders_only(2, {shader(Stage::kClosestHit), shader(Stage::kMiss)}, segments);
  EXPECT_EQ(time(w), config.sm.alu_latency * 17);
}

TEST_F(SmTest, lanes_reconverge_in_their_caller) {
  Workload w = rays_only(2);
  w.shaders = {shader(Stage::kRayGeneration), shader(Stage::kClosestHit), shader(Stage::kMiss)};
  w.segments = {segment(0, 0, {}, 0), segment(0, 1, alu(10)), segment(0, 0, alu(5)),
                segment(1, 0, {}, 1), segment(1, 2, alu(7)),  segment(1, 0, alu(5))};
  w.dispatches[0].segment_count = w.segments.size();
  EXPECT_EQ(run(w).cycles, overhead(config) + config.sm.alu_latency * (10 + 7 + 5));
}

TEST_F(SmTest, the_greedy_warp_goes_on_before_an_older_one) {
  config.sm.alu_latency = Cycles{1};
  config.sm.warps = 2;
  // Alone among ready warps nothing stalls: warp 0 runs to its trace before warp 1 starts.
  Workload w = rays_only(64);
  w.shaders = {shader(Stage::kRayGeneration)};
  for (std::uint32_t l = 0; l < 64; ++l) {
    w.segments.push_back(segment(l, 0, alu(5), l));
  }
  w.dispatches[0].segment_count = w.segments.size();
  run(w);
  ASSERT_EQ(source.order.size(), 64u);
  EXPECT_EQ(source.order.front(), 0u);
  EXPECT_EQ(source.order[32], 32u);
  // Warp 0: 5 issues and a trace; warp 1 the same after it.
  EXPECT_EQ(run(w).cycles, Cycles{12 - 1} + overhead(config));
}

TEST_F(SmTest, the_oldest_ready_warp_follows_a_stalled_one) {
  config.sm.warps = 3;
  config.sm.alu_latency = Cycles{2};
  Workload w = rays_only(96);
  w.shaders = {shader(Stage::kRayGeneration)};
  for (std::uint32_t l = 0; l < 96; ++l) {
    w.segments.push_back(segment(l, 0, alu(l < 64 ? 4 : 1), l));
  }
  w.dispatches[0].segment_count = w.segments.size();
  run(w);
  // Warps 0 and 1 alternate; the young warp 2, though short, gets no issue before they are done.
  ASSERT_EQ(source.order.size(), 96u);
  EXPECT_EQ(source.order[0], 0u);
  EXPECT_EQ(source.order[32], 32u);
  EXPECT_EQ(source.order[64], 64u);
}

TEST_F(SmTest, a_load_that_hits_l1_costs_the_l1_latency) {
  config.sm.words_per_load = 1;
  Workload w = same(1, loads(1));
  const Cycles once = time(w);
  // The same lane reads the same stream address again in a second segment.
  w.segments.push_back(w.segments[0]);
  w.dispatches[0].segment_count = 2;
  EXPECT_EQ(time(w) - once, config.l1.latency);
}

TEST_F(SmTest, ideal_shader_memory_causes_no_traffic) {
  config.shader_memory = ShaderMemory::kIdeal;
  const SimulationResult r = run(same(32, loads(16)));
  EXPECT_EQ(r.sm.lsu_sectors, 0u);
  EXPECT_GT(r.sm.loads, 0u);
}

TEST_F(SmTest, hit_shaders_that_hit_the_same_primitive_share_its_sectors) {
  Workload w = rays_only(32);
  w.shaders = {shader(Stage::kRayGeneration), shader(Stage::kClosestHit)};
  w.blas.resize(1);
  w.blas[0].triangles.resize(64);
  w.blas[0].geometries = {{0, 64, true}};
  w.tlas.resize(1);
  w.tlas[0].instances.resize(1);
  w.tlas[0].instances[0].blas = 0;
  for (std::uint32_t l = 0; l < 32; ++l) {
    w.driver_hits[l] = {HitState::kHit, 1, 0, 0, 5, 0xfe};
    w.segments.push_back(segment(l, 0, {}, l));
    w.segments.push_back(segment(l, 1, loads(8)));
  }
  w.dispatches[0].segment_count = w.segments.size();
  const std::uint64_t shared = run(w).sm.lsu_sectors;
  for (std::uint32_t l = 0; l < 32; ++l) {
    w.driver_hits[l].primitive = l;
  }
  const std::uint64_t apart = run(w).sm.lsu_sectors;
  EXPECT_EQ(apart, 32 * shared);
}

TEST_F(SmTest, a_load_store_queue_without_room_stalls_the_warp_and_says_so) {
  config.sm.lsu_queue = 4;
  config.sm.lsu_sectors_per_cycle = 1;
  const SimulationResult r = run(same(128, loads(64)));
  EXPECT_GT(r.scheduler_reasons[static_cast<std::size_t>(SchedulerReason::kWaitLsu)], 0u);
}

TEST_F(SmTest, every_scheduler_cycle_has_one_reason) {
  const SimulationResult r = run(same(96, {10, 3, 4, 8, 4, 2, 6, 5}));
  std::uint64_t sum = 0;
  for (const std::uint64_t c : r.scheduler_reasons) {
    sum += c;
  }
  EXPECT_EQ(sum, r.cycles.value * config.sm.schedulers);
}

TEST_F(SmTest, more_warps_than_slots_wait_for_a_slot) {
  config.sm.warps = 1;
  const Cycles one = run(same(32, alu(10))).cycles;
  EXPECT_EQ(run(same(96, alu(10))).cycles, one * 3);
}

TEST_F(SmTest, segments_out_of_order_are_refused) {
  Workload w = same(2, alu(1));
  std::swap(w.segments[0], w.segments[1]);
  EXPECT_THROW(run(w), UserError);
}

}  // namespace
}  // namespace a2rt::timing::test
