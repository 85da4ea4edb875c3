// The RT unit: fetches, merging, testers, stack, contexts, warp buffer, round trips. Exact cycles.
#include "a2rt/timing/rt_engine.h"

#include <gtest/gtest.h>

#include "mocks.h"

namespace a2rt::timing::test {
namespace {

constexpr std::size_t kNode = static_cast<std::size_t>(Traffic::kNode);

struct Rt : InBothModels {
  MachineConfig config = one_sm(GetParam());
  ScriptedSource source;
  SimulationResult run(std::uint32_t launches, std::uint32_t rays = 1) {
    return simulate(rays_only(launches, rays), source, config);
  }
  // Cycles of the rays alone.
  Cycles time(std::uint32_t launches, std::uint32_t rays = 1) {
    return run(launches, rays).cycles - overhead(config);
  }
  // Puts the sectors of `events` in L1 by tracing one ray that reads them first.
  std::vector<Event> twice(const std::vector<Event>& events) {
    std::vector<Event> all = events;
    all.insert(all.end(), events.begin(), events.end());
    return all;
  }
};

TEST_P(Rt, a_ray_without_events_costs_nothing_but_the_return) { EXPECT_EQ(time(1), Cycles{0}); }

TEST_P(Rt, a_fetch_that_hits_l1_costs_exactly_the_l1_latency) {
  source.everyone = {fetch(0)};
  const Cycles once = time(1);
  source.everyone = twice(source.everyone);
  EXPECT_EQ(time(1) - once, config.l1.latency);
}

TEST_P(Rt, a_result_is_stored_through_the_port_and_nothing_waits_for_it) {
  source.everyone = {count_event(EventKind::kBoxTest)};
  const SimulationResult plain = run(1);
  source.everyone = {fetch(0, 40, Traffic::kResult), count_event(EventKind::kBoxTest)};
  const SimulationResult stored = run(1);
  EXPECT_EQ(stored.ray_cycles.sum(), plain.ray_cycles.sum());
  EXPECT_EQ(stored.rt.stores_sent, 2u);
  EXPECT_EQ(stored.l1.writes[static_cast<std::size_t>(Traffic::kResult)], 2u);
  EXPECT_EQ(stored.l2.writes[static_cast<std::size_t>(Traffic::kResult)], 2u);
  EXPECT_EQ(stored.rt.sectors_sent, 0u);
}

TEST_P(Rt, a_test_after_a_fetch_waits_for_the_data) {
  source.everyone = {fetch(0)};
  const Cycles alone = time(1);
  source.everyone.push_back(count_event(EventKind::kBoxTest, 6));
  EXPECT_EQ(time(1) - alone, config.rt.tester(Tester::kBox).latency);
}

TEST_P(Rt, the_two_kinds_of_boxes_of_a_node_are_tested_side_by_side) {
  config.rt.tester(Tester::kBox).latency = Cycles{6};
  config.rt.tester(Tester::kQBox).latency = Cycles{2};
  source.everyone = {count_event(EventKind::kBoxTest, 1), count_event(EventKind::kQBoxTest, 5)};
  EXPECT_EQ(time(1), Cycles{6});
  // A quantized test that needs the box test's result, through a quantization, comes after it.
  source.everyone = {count_event(EventKind::kBoxTest, 1), count_event(EventKind::kQuantizeRay),
                     count_event(EventKind::kQBoxTest, 5)};
  EXPECT_EQ(time(1), Cycles{6 + 4 + 2});
}

TEST_P(Rt, six_boxes_of_a_node_are_six_tests_on_the_boxes_there_are) {
  config.rt.tester(Tester::kBox) = {2, Cycles{6}, Cycles{1}};
  source.everyone = {count_event(EventKind::kBoxTest, 6)};
  EXPECT_EQ(time(1), Cycles{2 + 6});
}

TEST_P(Rt, rays_queue_for_a_single_tester) {
  config.rt.tester(Tester::kTriangle) = {1, Cycles{27}, Cycles{2}};
  source.everyone = {count_event(EventKind::kTriangleTest)};
  EXPECT_EQ(time(32), Cycles{31 * 2 + 27});
}

TEST_P(Rt, the_port_sends_one_sector_per_cycle) {
  source.everyone = {fetch(0, 256), fetch(0, 256)};
  const SimulationResult once = run(1);
  source.everyone.push_back(fetch(0, 256));
  // All eight sectors are in L1: the last leaves in the eighth cycle.
  EXPECT_EQ(run(1).cycles - once.cycles, config.l1.latency + Cycles{7});
  EXPECT_EQ(once.rt.sectors_sent, 16u);
}

TEST_P(Rt, a_line_asked_for_again_counts_as_what_it_is_asked_for_now) {
  source.everyone = {fetch(0, 32, Traffic::kNode), count_event(EventKind::kBoxTest),
                     fetch(32, 32, Traffic::kTriangle)};
  const SimulationResult result = run(1);
  EXPECT_EQ(result.l1.reads[kNode], 1u);
  EXPECT_EQ(result.l1.reads[static_cast<std::size_t>(Traffic::kTriangle)], 1u);
}

TEST_P(Rt, a_port_of_two_sectors_halves_the_sending) {
  config.rt.port_sectors = 2;
  source.everyone = {fetch(0, 256), fetch(0, 256)};
  const Cycles once = run(1).cycles;
  source.everyone.push_back(fetch(0, 256));
  EXPECT_EQ(run(1).cycles - once, config.l1.latency + Cycles{3});
}

TEST_P(Rt, a_warp_of_identical_rays_costs_one_rays_fetches) {
  for (std::uint64_t node = 0; node < 10; ++node) {
    source.everyone.push_back(fetch(node * 4096, 64));
    source.everyone.push_back(count_event(EventKind::kBoxTest, 6));
  }
  const SimulationResult one = run(1);
  const SimulationResult warp = run(32);
  EXPECT_EQ(warp.cycles, one.cycles);
  EXPECT_EQ(warp.l1.reads, one.l1.reads);
  EXPECT_EQ(warp.rt.sectors_sent, one.rt.sectors_sent);
  EXPECT_EQ(warp.rt.sectors_wanted[kNode], 32 * one.rt.sectors_wanted[kNode]);
}

TEST_P(Rt, rays_that_read_different_lines_are_not_merged) {
  for (std::uint32_t ray = 0; ray < 32; ++ray) {
    source.script[ray] = {fetch(ray * 4096ull)};
  }
  EXPECT_EQ(run(32).rt.sectors_sent, 32u);
}

TEST_P(Rt, adjacent_records_of_two_kinds_are_one_read) {
  source.everyone = {fetch(0, 90, Traffic::kGroupNode)};
  const Cycles one = time(1);
  source.everyone = {fetch(0, 45, Traffic::kGroupNode), fetch(45, 45, Traffic::kSubNode)};
  const SimulationResult r = run(1);
  EXPECT_EQ(r.cycles - overhead(config), one);
  EXPECT_EQ(r.rt.sectors_sent, 3u);
  EXPECT_EQ(r.rt.fetches[static_cast<std::size_t>(Traffic::kSubNode)], 1u);
}

TEST_P(Rt, a_stack_within_its_depth_causes_no_traffic) {
  config.rt.stack_entries = 8;
  source.everyone = {count_event(EventKind::kPush, 8)};
  for (int i = 0; i < 8; ++i) {
    source.everyone.push_back(count_event(EventKind::kPop));
  }
  const SimulationResult r = run(1);
  EXPECT_EQ(r.rt.stores_sent, 0u);
  EXPECT_EQ(r.cycles - overhead(config), Cycles{0});
}

TEST_P(Rt, one_entry_too_many_spills_one_sector_and_reads_it_back) {
  config.rt.stack_entries = 8;
  source.everyone = {count_event(EventKind::kPush, 9)};
  for (int i = 0; i < 9; ++i) {
    source.everyone.push_back(count_event(EventKind::kPop));
  }
  const SimulationResult r = run(1);
  EXPECT_EQ(r.rt.stack_spills, 1u);
  EXPECT_EQ(r.rt.stack_fills, 1u);
  EXPECT_EQ(r.rt.stores_sent, 1u);
  // The store takes the port in cycle 0, the load in cycle 1; it hits what the store left in L1.
  EXPECT_EQ(r.cycles - overhead(config), Cycles{1} + config.l1.latency);
}

TEST_P(Rt, deeper_stacks_spill_four_entries_per_sector) {
  config.rt.stack_entries = 8;
  source.everyone = {count_event(EventKind::kPush, 24)};
  for (int i = 0; i < 24; ++i) {
    source.everyone.push_back(count_event(EventKind::kPop));
  }
  const SimulationResult r = run(1);
  EXPECT_EQ(r.rt.stack_spills, 4u);
  EXPECT_EQ(r.rt.stack_fills, 4u);
}

TEST_P(Rt, an_unlimited_stack_never_spills) {
  config.rt.stack_entries = 0;
  source.everyone = {count_event(EventKind::kPush, 1000)};
  EXPECT_EQ(run(1).rt.stack_spills, 0u);
}

TEST_P(Rt, popping_more_than_was_pushed_is_an_error) {
  source.everyone = {count_event(EventKind::kPop)};
  EXPECT_THROW(run(1), InternalError);
}

Event context_pop(Traffic record = Traffic::kGroupNode) {
  return {EventKind::kContextPop, record, 1, 45, 8192};
}
Event context_forget() { return count_event(EventKind::kContextPop, 0); }

TEST_P(Rt, a_context_kept_on_the_stack_comes_back_for_free) {
  source.everyone = {count_event(EventKind::kContextPush), context_pop()};
  EXPECT_EQ(time(1), Cycles{0});
}

TEST_P(Rt, a_refetched_context_costs_its_record_a_box_test_and_a_quantization) {
  // A machine may have anchor units that this design does not use.
  ASSERT_GT(config.rt.tester(Tester::kAnchor).count, 0u);
  config.rt.context = ContextPolicy::kRefetch;
  source.everyone = {fetch(8192, 45)};
  const Cycles record = time(1);
  source.everyone = {count_event(EventKind::kContextPush), context_pop()};
  const SimulationResult r = run(1);
  EXPECT_EQ(r.cycles - overhead(config), record + config.rt.tester(Tester::kBox).latency +
                                             config.rt.tester(Tester::kQuantizer).latency);
  EXPECT_EQ(r.rt.context_refetches, 1u);
}

TEST_P(Rt, a_refetched_anchor_costs_its_record_and_an_anchor_test) {
  config.rt.context = ContextPolicy::kRefetch;
  source.everyone = {fetch(8192, 45)};
  const Cycles record = time(1);
  source.everyone = {count_event(EventKind::kContextPush), context_pop(Traffic::kAnchor)};
  EXPECT_EQ(time(1), record + config.rt.tester(Tester::kAnchor).latency);
}

TEST_P(Rt, contexts_beyond_the_on_chip_stack_go_to_memory) {
  config.rt.context_entries = 1;
  source.everyone = {count_event(EventKind::kContextPush), count_event(EventKind::kContextPush),
                     context_pop(), context_pop()};
  const SimulationResult r = run(1);
  EXPECT_EQ(r.rt.context_spills, 1u);
  EXPECT_EQ(r.rt.context_fills, 1u);
}

TEST_P(Rt, a_forgotten_context_leaves_its_place_to_the_next) {
  config.rt.context_entries = 1;
  source.everyone.clear();
  for (int i = 0; i < 6; ++i) {
    source.everyone.push_back(count_event(EventKind::kContextPush));
    source.everyone.push_back(context_forget());
  }
  const SimulationResult r = run(1);
  EXPECT_EQ(r.cycles - overhead(config), Cycles{0});
  EXPECT_EQ(r.rt.context_saves, 6u);
  EXPECT_EQ(r.rt.context_spills, 0u);
  EXPECT_EQ(r.rt.context_restores, 0u);
  EXPECT_EQ(r.rt.events[static_cast<std::size_t>(EventKind::kContextPop)], 0u);
}

TEST_P(Rt, a_full_warp_buffer_makes_the_next_warp_wait) {
  config.rt.warps = 1;
  config.sm.schedulers = 2;
  source.everyone = {count_event(EventKind::kTransform)};
  const Cycles latency = config.rt.tester(Tester::kTransform).latency;
  EXPECT_EQ(time(64), latency * 2);
  config.rt.warps = 2;
  EXPECT_EQ(time(64), latency);
}

TEST_P(Rt, every_lane_cycle_and_every_unit_cycle_has_one_reason) {
  source.everyone = {fetch(0, 64), count_event(EventKind::kBoxTest, 6)};
  const SimulationResult r = run(20);
  std::uint64_t unit = 0, lanes = 0;
  for (const std::uint64_t c : r.rt_reasons) {
    unit += c;
  }
  for (const std::uint64_t c : r.rt.lane_cycles) {
    lanes += c;
  }
  EXPECT_EQ(unit, r.cycles.value);
  EXPECT_EQ(lanes, 32 * r.rt.warp_cycles);
  EXPECT_EQ(r.rt.lane_cycles[static_cast<std::size_t>(LaneReason::kInactive)],
            12 * r.rt.warp_cycles);
  EXPECT_EQ(r.rt_reasons[static_cast<std::size_t>(RtReason::kFetch)], 2u);
  EXPECT_EQ(r.rt_reasons[static_cast<std::size_t>(RtReason::kTest)],
            config.rt.tester(Tester::kBox).latency.value);
}

TEST_P(Rt, a_machine_without_the_tester_a_ray_needs_is_a_user_error) {
  config.rt.tester(Tester::kQBox).count = 0;
  source.everyone = {count_event(EventKind::kQBoxTest, 6)};
  EXPECT_THROW(run(1), UserError);
}

TEST_P(Rt, full_mshrs_hold_up_what_comes_later) {
  source.everyone = {fetch(0, 64)};
  source.everyone = {fetch(0, 64)};
  const Cycles together = time(1);
  config.l1.mshrs = 1;
  const SimulationResult r = run(1);
  EXPECT_GT(r.cycles - overhead(config), together + config.l2.latency);
  EXPECT_GE(r.l1.mshr_full, 1u);
  EXPECT_EQ(r.rt.sectors_sent, 2u);
  // Reserved ahead, the port has passed the second on already.
  const std::uint64_t blocked = r.rt_reasons[static_cast<std::size_t>(RtReason::kMshrFull)];
  EXPECT_EQ(blocked > 0, GetParam() == Model::kQueued);
}

// Any-hit: ray 0 of each launch leaves for the SM once.
struct Candidates : Rt {
  Workload workload(std::uint32_t lanes, std::uint32_t alu) {
    Workload w = rays_only(lanes);
    w.shaders = {shader(capture::Stage::kRayGeneration), shader(capture::Stage::kAnyHit)};
    for (std::uint32_t l = 0; l < lanes; ++l) {
      w.segments.push_back(segment(l, 0, {}, l));
      w.segments.push_back(segment(l, 1, {alu}));
    }
    w.dispatches[0].segment_count = w.segments.size();
    return w;
  }
};

TEST_P(Candidates, a_round_trip_costs_both_ways_and_the_shader) {
  config.sm.independent_instructions = 1;
  source.everyone = {count_event(EventKind::kAnyHit, 0)};
  const Cycles shader_time = config.sm.alu_latency * 10;
  EXPECT_EQ(cycles_of(workload(1, 10), source, config) - overhead(config),
            config.rt.callback_latency * 2 + shader_time);
}

TEST_P(Candidates, candidates_of_a_warp_are_judged_together) {
  source.everyone = {count_event(EventKind::kAnyHit, 0)};
  const SimulationResult one = simulate(workload(1, 10), source, config);
  const SimulationResult all = simulate(workload(32, 10), source, config);
  EXPECT_EQ(one.cycles, all.cycles);
  EXPECT_EQ(all.rt.round_trips, 1u);
  EXPECT_EQ(all.rt.candidates, 32u);
}

TEST_P(Candidates, a_threshold_of_one_lane_sends_a_candidate_before_the_others_are_ready) {
  source.everyone = {count_event(EventKind::kTransform), count_event(EventKind::kAnyHit, 0)};
  source.script[0] = {count_event(EventKind::kAnyHit, 0)};
  config.rt.callback_lanes = 1;
  EXPECT_EQ(simulate(workload(2, 10), source, config).rt.round_trips, 2u);
  config.rt.callback_lanes = 0;
  EXPECT_EQ(simulate(workload(2, 10), source, config).rt.round_trips, 1u);
}

INSTANTIATE_TEST_SUITE_P(Models, Rt, kBothModels, model_name);
INSTANTIATE_TEST_SUITE_P(Models, Candidates, kBothModels, model_name);

}  // namespace
}  // namespace a2rt::timing::test
