// The machine as a whole: scaling, conservation, determinism, watchdog, edge cases.
#include <gtest/gtest.h>

#include <thread>

#include "a2rt/timing/memory_system.h"
#include "a2rt/timing/result_json.h"
#include "a2rt/timing/simulator.h"
#include "a2rt/workload/synthetic.h"
#include "mocks.h"

namespace a2rt::timing::test {
namespace {

std::uint64_t total(const TrafficCounts& counts) {
  std::uint64_t sum = 0;
  for (const std::uint64_t c : counts) {
    sum += c;
  }
  return sum;
}

struct Machine : InBothModels {
  static MachineConfig table1() {
    MachineConfig config;
    config.model = GetParam();
    return config;
  }
};

TEST_P(Machine, an_empty_workload_takes_no_time) {
  ScriptedSource source;
  EXPECT_EQ(simulate(Workload{}, source, table1()).cycles, Cycles{0});
  EXPECT_EQ(simulate(rays_only(0), source, table1()).cycles, Cycles{0});
}

TEST_P(Machine, one_ray_takes_the_sum_of_its_parts) {
  ScriptedSource source;
  MachineConfig config = one_sm(GetParam());
  config.dram.mhz = config.core_mhz;
  source.everyone = {fetch(0), count_event(EventKind::kBoxTest, 6),
                     count_event(EventKind::kTriangleTest)};
  const Cycles dram =
      config.dram.extra_latency + config.dram.rcd + config.dram.cl + config.dram.burst;
  EXPECT_EQ(cycles_of(rays_only(1), source, config),
            l2_hit(config) + dram + Cycles{4} + Cycles{4} + overhead(config));
}

TEST_P(Machine, a_launch_without_rays_or_segments_still_ends) {
  ScriptedSource source;
  Workload w = rays_only(4);
  w.rays.clear();
  w.driver_hits.clear();
  w.dispatches[0].ray_count = 0;
  EXPECT_EQ(simulate(w, source, one_sm(GetParam())).sm.warps, 1u);
}

// The place in the SM still holds what its last warp left behind.
TEST_P(Machine, a_warp_without_rays_or_segments_ends_also_where_another_was_before) {
  ScriptedSource source;
  source.everyone = {count_event(EventKind::kTransform)};
  MachineConfig config = one_sm(GetParam());
  config.sm.warps = 1;
  Workload w = rays_only(96, 1, 32);
  // The second of three rows traces nothing.
  w.rays.erase(w.rays.begin() + 32, w.rays.begin() + 64);
  w.driver_hits.resize(w.rays.size());
  w.candidate_first.assign(w.rays.size() + 1, 0);
  w.dispatches[0].ray_count = w.rays.size();
  const SimulationResult result = simulate(w, source, config);
  EXPECT_EQ(result.warps.size(), 3u);
  EXPECT_EQ(result.rt.rays, 64u);
}

TEST_P(Machine, an_rt_unit_has_places_for_sixty_four_warps) {
  ScriptedSource source;
  source.everyone = {fetch(0), count_event(EventKind::kBoxTest), fetch(4096)};
  MachineConfig config = one_sm(GetParam());
  config.sm.warps = config.rt.warps = 64;
  const SimulationResult result = simulate(rays_only(80 * 32, 1, 32), source, config);
  EXPECT_EQ(result.rt.warps, 80u);
  config.rt.warps = 65;
  EXPECT_THROW(simulate(rays_only(32), source, config), InternalError);
}

TEST_P(Machine, eight_sms_trace_eight_warps_in_the_time_of_one) {
  ScriptedSource source;
  MachineConfig config = one_sm(GetParam());
  config.rt.warps = 1;
  config.rt.tester(Tester::kTransform) = {1, Cycles{10}, Cycles{1}};
  source.everyone = {count_event(EventKind::kTransform)};
  const Cycles one = cycles_of(rays_only(8 * 32), source, config);
  config.sm.count = 8;
  config.rt.tester(Tester::kTransform).count = 8;
  for (TesterConfig& t : config.rt.testers) {
    t.count = std::max(t.count, 8u);
  }
  const Cycles eight = cycles_of(rays_only(8 * 32), source, config);
  // 32 rays on one tester: 31 starts after the first, then its latency.
  EXPECT_EQ(eight, Cycles{31 + 10} + overhead(config));
  // One SM with one place in its RT unit traces them one after the other.
  EXPECT_EQ(one, Cycles{8 * (31 + 10)} + overhead(config));
}

// SMs run one after the other for as long as an L2 hit takes; their warps must not show it.
TEST_P(Machine, the_sm_that_is_free_first_gets_the_next_warp_however_long_the_stretch) {
  ScriptedSource source;
  MachineConfig config = one_sm(GetParam());
  config.sm.count = 2;
  config.sm.warps = 1;
  config.sm.independent_instructions = 1;
  for (TesterConfig& t : config.rt.testers) {
    t.count = 256;
  }
  // Three warps in a row: long, short, long.
  std::vector<Segment> segments;
  for (std::uint32_t l = 0; l < 96; ++l) {
    segments.push_back(segment(l, 0, {l / 32 == 1 ? 10u : 100u}));
  }
  const Workload w = shaders_only(96, {shader(capture::Stage::kRayGeneration)}, segments);
  const Cycles both = config.sm.alu_latency * 110 + Cycles{2};
  for (const Cycles latency : {Cycles{1}, Cycles{160}, Cycles{100'000}}) {
    config.l2.latency = latency;
    EXPECT_EQ(cycles_of(w, source, config), both) << latency.value;
  }
}

TEST_P(Machine, how_far_the_parts_run_alone_matters_to_the_host_only) {
  NoisySource source;
  MachineConfig config = table1();
  SimulationOptions options;
  const Workload w = rays_only(4096, 2, 64);
  const SimulationResult far = simulate(w, source, config, options);
  options.stretch = Cycles{1};
  const SimulationResult near = simulate(w, source, config, options);
  EXPECT_EQ(near.rt.fetch_bytes, far.rt.fetch_bytes);
  EXPECT_EQ(near.rt.events, far.rt.events);
  // What reaches a slice in the same cycle from several SMs may be served in another order.
  EXPECT_NEAR(static_cast<double>(near.cycles.value) / static_cast<double>(far.cycles.value), 1,
              0.03);
  EXPECT_NEAR(
      static_cast<double>(total(near.l2.misses)) / static_cast<double>(total(far.l2.misses)), 1,
      0.01);
}

TEST_P(Machine, a_ray_without_events_does_not_take_the_next_groups_rays_with_it) {
  ScriptedSource source;
  source.script[1] = {count_event(EventKind::kTransform)};
  // Two lanes in two shaders: each traces on its own, the first a ray that ends at once.
  const Workload w = [] {
    Workload rays = rays_only(2);
    rays.shaders = {shader(capture::Stage::kRayGeneration), shader(capture::Stage::kMiss)};
    rays.segments = {segment(0, 1, {1}, 0), segment(1, 0, {1}, 1)};
    rays.dispatches[0].segment_count = 2;
    return rays;
  }();
  const SimulationResult r = simulate(w, source, one_sm(GetParam()));
  EXPECT_EQ(r.rays(), 2u);
  EXPECT_EQ(source.order, (std::vector<std::uint32_t>{0, 1}));
}

TEST_P(Machine, odd_numbers_of_testers_are_spread_evenly) {
  ScriptedSource source;
  MachineConfig config = one_sm(GetParam());
  config.sm.count = 8;
  config.rt.tester(Tester::kBox) = {15, Cycles{6}, Cycles{1}};
  const SimulationResult r = simulate(rays_only(32), source, config);
  EXPECT_EQ(r.testers[static_cast<std::size_t>(Tester::kBox)].count, 15u);
}

TEST_P(Machine, fewer_testers_than_rt_units_are_refused) {
  ScriptedSource source;
  MachineConfig config = table1();
  config.rt.tester(Tester::kBox).count = 7;
  EXPECT_THROW(simulate(rays_only(32), source, config), UserError);
}

TEST_P(Machine, counts_agree_between_the_levels) {
  NoisySource source;
  MachineConfig config = table1();
  config.rt.stack_entries = 4;
  const SimulationResult r = simulate(rays_only(4096, 2, 64), source, config);
  EXPECT_EQ(r.rays(), 8192u);
  EXPECT_EQ(total(r.l1.reads), total(r.l1.hits) + total(r.l1.merges) + total(r.l1.misses));
  EXPECT_EQ(total(r.l1.misses), total(r.l2.reads));
  EXPECT_EQ(total(r.l2.misses), r.dram.reads);
  EXPECT_EQ(total(r.l1.reads), r.rt.sectors_sent);
  EXPECT_GT(r.rt.stack_spills, 0u);
  EXPECT_LE(r.rt.sectors_sent, total(r.rt.sectors_wanted));
}

TEST_P(Machine, the_same_run_gives_the_same_everything) {
  const Workload w = rays_only(2048, 2, 64);
  NoisySource a, b;
  const SimulationResult first = simulate(w, a, table1());
  const SimulationResult second = simulate(w, b, table1());
  EXPECT_EQ(first.cycles, second.cycles);
  EXPECT_EQ(first.launch_cycles, second.launch_cycles);
  EXPECT_EQ(first.l1.hits, second.l1.hits);
  EXPECT_EQ(first.dram.row_hits, second.dram.row_hits);
  EXPECT_EQ(first.rt_reasons, second.rt_reasons);
}

TEST_P(Machine, runs_side_by_side_on_two_host_threads_equal_a_run_alone) {
  const Workload w = rays_only(2048, 2, 64);
  const auto run = [&] {
    NoisySource source;
    return simulate(w, source, table1());
  };
  const SimulationResult alone = run();
  SimulationResult first, second;
  std::thread other([&] { first = run(); });
  second = run();
  other.join();
  for (const SimulationResult* r : {&first, &second}) {
    EXPECT_EQ(r->cycles, alone.cycles);
    EXPECT_EQ(r->launch_cycles, alone.launch_cycles);
    EXPECT_EQ(r->l1.hits, alone.l1.hits);
    EXPECT_EQ(r->l2.hits, alone.l2.hits);
    EXPECT_EQ(r->dram.row_hits, alone.dram.row_hits);
    EXPECT_EQ(r->scheduler_reasons, alone.scheduler_reasons);
    EXPECT_EQ(r->rt_reasons, alone.rt_reasons);
  }
}

TEST_P(Machine, cycles_of_a_launch_id_are_the_sum_over_its_rays) {
  NoisySource source;
  const SimulationResult r = simulate(rays_only(256, 3, 32), source, table1());
  std::uint64_t sum = 0;
  for (const std::uint32_t c : r.launch_cycles) {
    sum += c;
  }
  EXPECT_EQ(sum, r.ray_cycles.sum());
  EXPECT_EQ(r.ray_cycles.count(), 768u);
}

TEST_P(Machine, dispatches_run_one_after_the_other) {
  ScriptedSource source;
  const MachineConfig config = one_sm(GetParam());
  source.everyone = {count_event(EventKind::kTransform)};
  Workload w = rays_only(32);
  const Cycles one = cycles_of(w, source, config);
  w.dispatches.push_back(w.dispatches[0]);
  w.dispatches[1].first_ray = 32;
  for (std::uint32_t l = 0; l < 32; ++l) {
    w.rays.push_back(w.rays[l]);
    w.rays.back().dispatch = 1;
  }
  w.driver_hits.resize(64);
  const SimulationResult r = simulate(w, source, config);
  EXPECT_EQ(r.cycles, one * 2);
  ASSERT_EQ(r.dispatches.size(), 2u);
  EXPECT_EQ(r.dispatches[0].rays, 32u);
}

TEST_P(Machine, frames_can_be_chosen) {
  ScriptedSource source;
  Workload w = rays_only(32);
  w.dispatches[0].frame = 3;
  SimulationOptions options;
  options.frames = {2};
  EXPECT_EQ(simulate(w, source, one_sm(GetParam()), options).rays(), 0u);
  options.frames = {3};
  EXPECT_EQ(simulate(w, source, one_sm(GetParam()), options).rays(), 32u);
}

TEST_P(Machine, a_dispatch_narrower_than_a_warp_leaves_lanes_inactive) {
  ScriptedSource source;
  source.everyone = {count_event(EventKind::kTransform)};
  const SimulationResult r = simulate(rays_only(40, 1, 20), source, one_sm(GetParam()));
  EXPECT_EQ(r.sm.warps, 2u);
  EXPECT_EQ(r.rays(), 40u);
}

// A test of a million cycles stands for a part that hangs.
TEST(Watchdog, a_hanging_tester_stops_the_run_with_a_dump_of_every_part) {
  ScriptedSource source;
  MachineConfig config = one_sm();
  config.watchdog_cycles = 5000;
  config.rt.tester(Tester::kTransform).latency = Cycles{1'000'000};
  source.everyone = {count_event(EventKind::kTransform)};
  try {
    simulate(rays_only(1), source, config);
    FAIL() << "the watchdog slept";
  } catch (const InternalError& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("no progress"), std::string::npos);
    for (const char* part : {"sm[0]", "rt[0]", "l1[0]", "memory:", "dram:"}) {
      EXPECT_NE(text.find(part), std::string::npos) << part;
    }
    EXPECT_NE(text.find("1 test"), std::string::npos) << text;
  }
}

// Without MSHRs no miss can ever leave: the lanes wait for data that nobody fetches.
TEST(Watchdog, a_real_deadlock_stops_the_run_and_shows_who_waits_for_what) {
  ScriptedSource source;
  MachineConfig config = one_sm();
  config.l1.mshrs = 0;
  source.everyone = {fetch(0)};
  try {
    simulate(rays_only(3), source, config);
    FAIL() << "a machine that stands still was taken for one that is done";
  } catch (const InternalError& e) {
    const std::string text = e.what();
    for (const char* part : {"nothing is left to happen", "in the RT unit", "blocked by MSHRs",
                             "3 fetch", "0/0 MSHRs in use"}) {
      EXPECT_NE(text.find(part), std::string::npos) << part << " is not in\n" << text;
    }
  }
}

TEST(Watchdog, a_slow_machine_that_makes_progress_is_left_alone) {
  ScriptedSource source;
  MachineConfig config = one_sm();
  config.watchdog_cycles = 5000;
  config.rt.tester(Tester::kTransform).latency = Cycles{4000};
  source.everyone.assign(10, count_event(EventKind::kTransform));
  EXPECT_EQ(cycles_of(rays_only(1), source, config), Cycles{40'000} + overhead(config));
}

TEST_P(Machine, synthetic_workloads_run_with_their_own_segments) {
  synthetic::Config scene;
  scene.primitives = 64;
  const Workload w = synthetic::make(scene);
  NoisySource source;
  const SimulationResult r = simulate(w, source, table1());
  EXPECT_EQ(r.rays(), w.rays.size());
}

// Memory is the limit here: misses of 8,192 rays all over 4 MB.
TEST(Models, agree_on_the_time_of_a_run_that_memory_bounds_and_on_its_traffic) {
  const Workload w = rays_only(4096, 2, 64);
  NoisySource source;
  MachineConfig config;
  const SimulationResult queued = simulate(w, source, config);
  config.model = Model::kReserved;
  const SimulationResult reserved = simulate(w, source, config);
  EXPECT_EQ(reserved.rt.events, queued.rt.events);
  EXPECT_EQ(reserved.rt.fetch_bytes, queued.rt.fetch_bytes);
  const auto near = [](auto a, auto b, double error) {
    EXPECT_NEAR(static_cast<double>(a) / static_cast<double>(b), 1, error);
  };
  near(reserved.cycles.value, queued.cycles.value, 0.08);
  near(reserved.rt.sectors_sent, queued.rt.sectors_sent, 0.02);
  near(total(reserved.l1.misses), total(queued.l1.misses), 0.01);
  near(reserved.dram.reads, queued.dram.reads, 0.02);
}

// A port of four sectors and an L1 of one cycle: requests left before they had come in.
TEST(Models, agree_on_one_ray_alone_whatever_the_port_and_the_latencies) {
  ScriptedSource source;
  source.everyone = {fetch(0, 256),     count_event(EventKind::kBoxTest, 6),   fetch(4096, 100),
                     fetch(40960, 128), count_event(EventKind::kTriangleTest), fetch(0, 256)};
  for (const std::uint32_t sectors : {1u, 2u, 4u, 8u}) {
    for (const std::uint64_t latency : {1u, 20u, 3000u}) {
      MachineConfig config = one_sm();
      config.rt.port_sectors = sectors;
      config.l1.banks = 16;
      config.l1.latency = config.l2.crossbar_latency = Cycles{latency};
      const Cycles queued = cycles_of(rays_only(1), source, config);
      config.model = Model::kReserved;
      // What is read from DRAM together comes together; one by one, it can be used as it comes.
      EXPECT_NEAR(static_cast<double>(cycles_of(rays_only(1), source, config).value),
                  static_cast<double>(queued.value), 16)
          << sectors << " sectors, latency " << latency;
    }
  }
}

TEST(Models, agree_on_what_rt_units_do_though_nothing_happens_for_thousands_of_cycles) {
  NoisySource source;
  MachineConfig config;
  config.l2.latency = Cycles{20'000};
  const Workload w = rays_only(1024, 2, 64);
  const auto fetching = [&](Model model) {
    config.model = model;
    const SimulationResult r = simulate(w, source, config);
    return static_cast<double>(r.rt_reasons[static_cast<std::size_t>(RtReason::kFetch)]);
  };
  EXPECT_NEAR(fetching(Model::kReserved) / fetching(Model::kQueued), 1, 0.03);
}

TEST(Watchdog, a_read_that_was_promised_for_later_is_no_standstill) {
  ScriptedSource source;
  MachineConfig config = one_sm(Model::kReserved);
  config.watchdog_cycles = 5000;
  config.l2.crossbar_latency = Cycles{4000};
  source.everyone = {fetch(0), fetch(1 << 20), fetch(2 << 20)};
  EXPECT_GT(cycles_of(rays_only(1), source, config), Cycles{24'000});
}

INSTANTIATE_TEST_SUITE_P(Models, Machine, kBothModels, model_name);

}  // namespace
}  // namespace a2rt::timing::test
