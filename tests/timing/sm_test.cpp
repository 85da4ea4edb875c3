// The SM: arithmetic latency and overlap, GTO order, divergence, loads, launch of warps.
#include "a2rt/timing/sm.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

#include "mocks.h"

namespace a2rt::timing::test {
namespace {

using capture::Stage;
std::array<std::uint32_t, 8> alu(std::uint32_t n) { return {n}; }
std::array<std::uint32_t, 8> sfu(std::uint32_t n) { return {0, n}; }
std::array<std::uint32_t, 8> loads(std::uint32_t words) { return {0, 0, 0, words}; }

struct SmTest : InBothModels {
  MachineConfig config = one_sm(GetParam());
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

TEST_P(SmTest, dependent_instructions_cost_one_latency_each) {
  EXPECT_EQ(time(same(1, alu(10))), config.sm.alu_latency * 10);
}

TEST_P(SmTest, independent_instructions_are_issued_back_to_back) {
  config.sm.independent_instructions = 5;
  // Two bursts of five: four more issues, then the latency of the last.
  EXPECT_EQ(time(same(1, alu(10))), (Cycles{4} + config.sm.alu_latency) * 2);
}

TEST_P(SmTest, a_full_warp_costs_what_one_lane_costs) {
  EXPECT_EQ(time(same(32, alu(10))), time(same(1, alu(10))));
}

TEST_P(SmTest, warps_hide_each_others_latency) {
  // Four warps of ten dependent instructions keep one scheduler busy every cycle.
  EXPECT_EQ(time(same(128, alu(10))), Cycles{39} + config.sm.alu_latency);
}

TEST_P(SmTest, schedulers_issue_in_parallel) {
  config.sm.schedulers = 4;
  EXPECT_EQ(time(same(128, alu(10))), config.sm.alu_latency * 10);
}

TEST_P(SmTest, sfu_instructions_are_an_interval_apart) {
  EXPECT_EQ(time(same(1, sfu(4))), config.sm.sfu_interval * 3 + config.sm.sfu_latency);
}

TEST_P(SmTest, a_warp_costs_the_maximum_over_its_lanes) {
  Workload w = same(2, alu(10));
  w.segments[1].counts[0] = 30;
  EXPECT_EQ(time(w), config.sm.alu_latency * 30);
}

TEST_P(SmTest, lanes_in_different_shaders_serialise) {
  const std::vector<Segment> segments = {segment(0, 0, alu(10)), segment(1, 1, alu(7))};
  const Workload w = shaders_only(2, {shader(Stage::kClosestHit), shader(Stage::kMiss)}, segments);
  EXPECT_EQ(time(w), config.sm.alu_latency * 17);
}

TEST_P(SmTest, lanes_reconverge_in_their_caller) {
  Workload w = rays_only(2);
  w.shaders = {shader(Stage::kRayGeneration), shader(Stage::kClosestHit), shader(Stage::kMiss)};
  w.segments = {segment(0, 0, {}, 0), segment(0, 1, alu(10)), segment(0, 0, alu(5)),
                segment(1, 0, {}, 1), segment(1, 2, alu(7)),  segment(1, 0, alu(5))};
  w.dispatches[0].segment_count = w.segments.size();
  EXPECT_EQ(run(w).cycles, overhead(config) + config.sm.alu_latency * (10 + 7 + 5));
}

TEST_P(SmTest, the_greedy_warp_goes_on_before_an_older_one) {
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

TEST_P(SmTest, the_oldest_ready_warp_follows_a_stalled_one) {
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

TEST_P(SmTest, a_load_that_hits_l1_costs_the_l1_latency) {
  config.sm.words_per_load = 1;
  Workload w = same(1, loads(1));
  const Cycles once = time(w);
  // The same lane reads the same stream address again in a second segment.
  w.segments.push_back(w.segments[0]);
  w.dispatches[0].segment_count = 2;
  EXPECT_EQ(time(w) - once, config.l1.latency);
}

TEST_P(SmTest, ideal_shader_memory_causes_no_traffic) {
  config.shader_memory = ShaderMemory::kIdeal;
  const SimulationResult r = run(same(32, loads(16)));
  EXPECT_EQ(r.sm.lsu_sectors, 0u);
  EXPECT_GT(r.sm.loads, 0u);
}

TEST_P(SmTest, hit_shaders_that_hit_the_same_primitive_share_its_sectors) {
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

TEST_P(SmTest, a_load_store_queue_without_room_stalls_the_warp_and_says_so) {
  config.sm.lsu_queue = 4;
  config.sm.lsu_sectors_per_cycle = 1;
  const SimulationResult r = run(same(128, loads(64)));
  EXPECT_GT(r.scheduler_reasons[static_cast<std::size_t>(SchedulerReason::kWaitLsu)], 0u);
}

TEST_P(SmTest, every_scheduler_cycle_has_one_reason) {
  const SimulationResult r = run(same(96, {10, 3, 4, 8, 4, 2, 6, 5}));
  std::uint64_t sum = 0;
  for (const std::uint64_t c : r.scheduler_reasons) {
    sum += c;
  }
  EXPECT_EQ(sum, r.cycles.value * config.sm.schedulers);
}

TEST_P(SmTest, more_warps_than_slots_wait_for_a_slot) {
  config.sm.warps = 1;
  const Cycles one = run(same(32, alu(10))).cycles;
  EXPECT_EQ(run(same(96, alu(10))).cycles, one * 3);
}

TEST_P(SmTest, segments_out_of_order_are_refused) {
  Workload w = same(2, alu(1));
  std::swap(w.segments[0], w.segments[1]);
  EXPECT_THROW(run(w), UserError);
}

// A scheduler that looks at its warps in every cycle and issues one instruction of arithmetic:
// greedy, then oldest. Returns each warp's residence; warps launch in order into free slots.
class PlainScheduler {
 public:
  using Instructions = std::array<std::uint32_t, 3>;  // uniform loads, ALU, SFU: in this order
  explicit PlainScheduler(const SmConfig& sm) : sm_(sm) {}

  std::vector<Cycles> run(const std::vector<Instructions>& warps) {
    std::vector<Cycles> residence(warps.size());
    std::vector<Slot> slots(sm_.warps);
    std::size_t launched = 0, retired = 0, last = slots.size();
    Cycles sfu_free;
    const auto launch = [&](Cycles now, Slot& slot) {
      if (launched < warps.size()) {
        slot = {true, launched, warps[launched], now, now, 0, Cycles{0}};
        ++launched;
      }
    };
    for (Slot& slot : slots) {
      launch(Cycles{0}, slot);
    }
    for (Cycles now; retired < warps.size(); now = now + Cycles{1}) {
      for (Slot& slot : slots) {
        if (slot.relaunch == now && now > Cycles{0}) {
          launch(now, slot);
        }
      }
      for (bool issued = false; !issued;) {
        std::size_t chosen = slots.size();
        for (std::size_t s = 0; s < slots.size(); ++s) {
          const bool ready =
              slots[s].live && slots[s].ready <= now && !(slots[s].kind() == 2 && sfu_free > now);
          if (ready && (chosen == slots.size() || s == last ||
                        (chosen != last && slots[s].warp < slots[chosen].warp))) {
            chosen = s;
          }
        }
        if (chosen == slots.size()) {
          break;
        }
        Slot& slot = slots[chosen];
        if (slot.kind() == 3) {
          residence[slot.warp] = now - slot.since;
          ++retired;
          slot.live = false;
          slot.relaunch = now + Cycles{1};
          continue;
        }
        issue(now, slot, sfu_free);
        last = chosen;
        issued = true;
      }
    }
    return residence;
  }

 private:
  struct Slot {
    bool live = false;
    std::size_t warp = 0;
    Instructions left{};
    Cycles since, ready;
    std::uint32_t in_burst = 0;
    Cycles relaunch;
    std::size_t kind() const { return left[0] > 0 ? 0 : left[1] > 0 ? 1 : left[2] > 0 ? 2 : 3; }
  };
  void issue(Cycles now, Slot& slot, Cycles& sfu_free) const {
    const std::size_t kind = slot.kind();
    const bool last = --slot.left[kind] == 0;
    if (kind == 2) {
      sfu_free = now + sm_.sfu_interval;
      slot.ready = now + (last ? sm_.sfu_latency : sm_.sfu_interval);
      return;
    }
    // The next of a burst need not wait for this one.
    if (++slot.in_burst == sm_.independent_instructions || last) {
      slot.in_burst = 0;
      slot.ready = now + (kind == 0 ? sm_.uniform_latency : sm_.alu_latency);
    } else {
      slot.ready = now + Cycles{1};
    }
  }
  SmConfig sm_;
};

struct SmBursts : SmTest {
  SmBursts() { config.sm.words_per_load = 1; }
  void expect_plain(const std::vector<PlainScheduler::Instructions>& warps) {
    std::vector<Segment> segments;
    std::array<std::uint64_t, 3> all{};
    for (std::uint32_t l = 0; l < warps.size() * kLanes; ++l) {
      const auto& [uniform, alu, sfu] = warps[l / kLanes];
      segments.push_back(segment(l, 0, {alu, sfu, uniform}));
    }
    for (const auto& warp : warps) {
      for (std::size_t kind = 0; kind < 3; ++kind) {
        all[kind] += warp[kind];
      }
    }
    const SimulationResult r = run(shaders_only(static_cast<std::uint32_t>(segments.size()),
                                                {shader(Stage::kRayGeneration)}, segments));
    const std::vector<Cycles> expected = PlainScheduler(config.sm).run(warps);
    ASSERT_EQ(r.warps.size(), warps.size());
    for (std::size_t w = 0; w < warps.size(); ++w) {
      ASSERT_EQ(r.warps[w].residence, expected[w]) << "warp " << w;
    }
    EXPECT_EQ(r.sm.uniform, all[0]);
    EXPECT_EQ(r.sm.alu, all[1]);
    EXPECT_EQ(r.sm.sfu, all[2]);
    EXPECT_EQ(r.scheduler_reasons[static_cast<std::size_t>(SchedulerReason::kIssueAlu)],
              all[0] + all[1]);
    EXPECT_EQ(r.scheduler_reasons[static_cast<std::size_t>(SchedulerReason::kIssueSfu)], all[2]);
  }
};

TEST_P(SmBursts, of_a_warp_alone_end_as_if_issued_one_by_one_whatever_their_number) {
  for (std::uint32_t burst = 1; burst <= 6; ++burst) {
    config.sm.independent_instructions = burst;
    for (std::uint32_t n = 0; n <= 2 * burst + 1; ++n) {
      expect_plain({{0, n, 0}});
      expect_plain({{n, 0, 0}});
      expect_plain({{n, 2 * burst + 1 - n, n % 3}});
    }
  }
}

TEST_P(SmBursts, of_a_warp_give_way_to_one_that_becomes_ready_amid_them) {
  config.sm.warps = 2;
  for (std::uint32_t burst = 1; burst <= 4; ++burst) {
    config.sm.independent_instructions = burst;
    // The second warp's end makes room for the third in any cycle of the first one's bursts.
    for (std::uint32_t n = 0; n < 12; ++n) {
      expect_plain({{0, 60, 0}, {0, n, 0}, {0, 9, 0}});
      expect_plain({{0, 60, 0}, {0, 0, n}, {2, 9, 3}});
    }
  }
}

TEST_P(SmBursts, of_any_warps_together_end_as_if_issued_one_by_one) {
  std::mt19937 engine(5);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(engine() % n); };
  for (std::uint32_t i = 0; i < 300; ++i) {
    config.sm.warps = 1 + below(4);
    config.sm.independent_instructions = 1 + below(5);
    std::vector<PlainScheduler::Instructions> warps(1 + below(8));
    for (auto& [uniform, alu, sfu] : warps) {
      uniform = below(3) == 0 ? below(12) : 0;
      alu = below(40);
      sfu = below(3) == 0 ? below(5) : 0;
    }
    expect_plain(warps);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, SmTest, kBothModels, model_name);
INSTANTIATE_TEST_SUITE_P(Models, SmBursts, kBothModels, model_name);

}  // namespace
}  // namespace a2rt::timing::test
