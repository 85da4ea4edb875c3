// Crossbar, L2 and DRAM: latencies, row buffer outcomes, peak bandwidths. Exact cycles.
#include "a2rt/timing/memory_system.h"

#include <gtest/gtest.h>

#include "mocks.h"

namespace a2rt::timing::test {
namespace {

class Sink final : public LineSink {
 public:
  void fill(Cycles first, Address line, SectorMask sectors) override {
    for_each_bit(sectors, [&](std::uint32_t s) {
      arrived.push_back({first, line + Bytes{s * kSectorBytes}});
      first += Cycles{1};
    });
  }
  std::vector<std::pair<Cycles, Address>> arrived;
};

struct Memory : ::testing::Test {
  MachineConfig config = one_sm();
  Calendar calendar;
  std::unique_ptr<MemorySystem> uut;
  std::unique_ptr<Sink> sink;
  Memory() {
    config.dram.mhz = config.core_mhz;  // one command cycle per core cycle: whole numbers
    config.l2.channels = 1;
    config.l2.slices_per_channel = 1;
  }
  void build() {
    uut = std::make_unique<MemorySystem>(config, calendar, calendar);
    sink = std::make_unique<Sink>();
    uut->connect(0, *sink, calendar);
  }
  void read(std::uint64_t address, bool write = false) {
    const Address a{address};
    uut->request(calendar.now(), 0, Address{line_of(a) * kLineBytes},
                 static_cast<SectorMask>(1u << sector_index(a)),
                 write ? Traffic::kShader : Traffic::kNode, write);
  }
  // Cycles from now until the sector arrives, with nothing else under way.
  Cycles time(std::uint64_t address) {
    const Cycles start = calendar.now();
    read(address);
    drain(calendar);
    EXPECT_EQ(sink->arrived.back().second, Address{address});
    return sink->arrived.back().first - start;
  }
  Cycles hit() const { return config.l2.crossbar_latency * 2 + config.l2.latency; }
  // L2 miss without the row commands.
  Cycles miss() const {
    return hit() + config.dram.extra_latency + config.dram.cl + config.dram.burst;
  }
  // Long enough for every bank to be ready again.
  void rest() {
    At idle(calendar, calendar.now() + Cycles{2000}, [](Cycles) {});
    drain(calendar);
  }
};

TEST_F(Memory, a_first_access_activates_its_row) {
  build();
  EXPECT_EQ(time(0), miss() + config.dram.rcd);
  EXPECT_EQ(uut->counts().dram.row_misses, 1u);
}

TEST_F(Memory, an_l2_hit_costs_crossbar_and_l2_latency) {
  build();
  time(0);
  EXPECT_EQ(time(0), hit());
  uut->check_drained();
}

TEST_F(Memory, another_sector_of_an_open_row_needs_no_activate) {
  build();
  time(0);
  rest();
  EXPECT_EQ(time(1024), miss());
  EXPECT_EQ(uut->counts().dram.row_hits, 1u);
}

TEST_F(Memory, another_row_of_a_bank_costs_precharge_and_activate) {
  build();
  time(0);
  rest();
  const std::uint64_t other_row = config.dram.row.value * config.dram.banks;
  EXPECT_EQ(time(other_row), miss() + config.dram.rp + config.dram.rcd);
  EXPECT_EQ(uut->counts().dram.row_conflicts, 1u);
}

TEST_F(Memory, another_bank_costs_an_activate_only) {
  build();
  time(0);
  rest();
  EXPECT_EQ(time(config.dram.row.value), miss() + config.dram.rcd);
  EXPECT_EQ(uut->counts().dram.row_misses, 2u);
}

TEST_F(Memory, a_second_clock_domain_is_converted_exactly) {
  config.dram.mhz = config.core_mhz * 2;
  build();
  // 20 + 20 + 4 command cycles at twice the clock.
  EXPECT_EQ(time(0), hit() + config.dram.extra_latency + Cycles{22});
}

// Clocks whose edges never meet, and a data bus that is the limit: 2.56 command cycles in a core
// cycle, a sector every `ccd` of them.
class OddClocks : public Memory, public ::testing::WithParamInterface<std::uint64_t> {};

TEST_P(OddClocks, a_stream_through_an_open_row_runs_at_the_peak_of_the_bus) {
  config.core_mhz = config.l2.mhz = 1365;
  config.dram.mhz = 3500;
  config.dram.ccd = config.dram.burst = Cycles{GetParam()};
  config.dram.row = Bytes{1 << 16};
  config.l2.mshrs = 1000;  // not to be the limit
  build();
  time(0);
  rest();
  constexpr std::uint64_t kSectors = 500;
  const std::size_t before = sink->arrived.size();
  for (std::uint64_t i = 0; i < kSectors; ++i) {
    read(1024 + i * kSectorBytes);
  }
  drain(calendar);
  const Cycles took = sink->arrived.back().first - sink->arrived[before].first;
  const double peak = static_cast<double>((kSectors - 1) * GetParam()) * 1365 / 3500;
  EXPECT_NEAR(static_cast<double>(took.value), peak, 2);
}

TEST_P(OddClocks, a_lone_access_is_late_by_less_than_a_core_cycle_for_each_crossing) {
  config.core_mhz = config.l2.mhz = 1365;
  config.dram.mhz = 3500;
  config.dram.ccd = config.dram.burst = Cycles{GetParam()};
  build();
  const std::uint64_t own = (config.dram.rcd + config.dram.cl + config.dram.burst).value;
  const double exact = static_cast<double>((hit() + config.dram.extra_latency).value) +
                       static_cast<double>(own) * 1365 / 3500;
  for (std::uint64_t i = 0; i < config.dram.banks; ++i) {
    const auto took = static_cast<double>(time(i * config.dram.row.value).value);
    EXPECT_GE(took, exact);
    // Up to the next command edge, and from the data to the next core edge.
    EXPECT_LT(took, exact + 1365.0 / 3500 + 1);
    rest();
  }
}

INSTANTIATE_TEST_SUITE_P(ColumnCycles, OddClocks, ::testing::Values(4, 8));

TEST_F(Memory, open_rows_are_served_before_older_conflicts) {
  build();
  time(0);
  rest();
  const std::uint64_t other_row = config.dram.row.value * config.dram.banks;
  const std::size_t before = sink->arrived.size();
  // Oldest first: a row hit, then a conflict in the same bank, then another row hit.
  read(1024);
  read(other_row);
  read(1056);
  drain(calendar);
  ASSERT_EQ(sink->arrived.size(), before + 3);
  EXPECT_EQ(sink->arrived[before].second, Address{1024});
  EXPECT_EQ(sink->arrived[before + 1].second, Address{1056});
  EXPECT_EQ(sink->arrived[before + 2].second, Address{other_row});
}

TEST_F(Memory, a_stream_through_an_open_row_runs_at_one_sector_per_ccd) {
  build();
  time(0);
  rest();
  const std::size_t before = sink->arrived.size();
  constexpr std::uint64_t kSectors = 32;
  for (std::uint64_t i = 0; i < kSectors; ++i) {
    read(1024 + i * kSectorBytes);
  }
  const Cycles start = calendar.now();
  drain(calendar);
  // The first takes a miss; each further one follows a column cycle later.
  const Cycles last = sink->arrived.back().first - start;
  EXPECT_EQ(sink->arrived.size() - before, kSectors);
  EXPECT_EQ(last, miss() + config.dram.ccd * (kSectors - 1));
}

TEST_F(Memory, a_stream_of_l2_hits_runs_at_one_sector_per_cycle) {
  build();
  constexpr std::uint64_t kSectors = 64;
  for (std::uint64_t i = 0; i < kSectors; ++i) {
    time(i * kSectorBytes);
  }
  const Cycles start = calendar.now();
  for (std::uint64_t i = 0; i < kSectors; ++i) {
    read(i * kSectorBytes);
  }
  drain(calendar);
  EXPECT_EQ(sink->arrived.back().first - start, hit() + Cycles{kSectors - 1});
}

TEST_F(Memory, the_sectors_of_a_line_come_one_cycle_apart) {
  build();
  for (std::uint64_t s = 0; s < kSectorsPerLine; ++s) {
    time(s * kSectorBytes);
  }
  const std::size_t before = sink->arrived.size();
  const Cycles start = calendar.now();
  uut->request(start, 0, Address{0}, 0xf, Traffic::kNode, false);
  drain(calendar);
  ASSERT_EQ(sink->arrived.size(), before + 4);
  for (std::uint64_t s = 0; s < kSectorsPerLine; ++s) {
    EXPECT_EQ(sink->arrived[before + s].first, start + hit() + Cycles{s});
  }
}

TEST_F(Memory, a_line_half_in_l2_is_answered_in_two_parts) {
  build();
  time(0);
  rest();
  const Cycles start = calendar.now();
  uut->request(start, 0, Address{0}, 0x3, Traffic::kNode, false);
  drain(calendar);
  EXPECT_EQ(sink->arrived[1].first, start + hit());
  // The missing sector is looked up a cycle later.
  EXPECT_EQ(sink->arrived[2].first, start + miss() + Cycles{1});
  uut->check_drained();
}

TEST_F(Memory, two_reads_of_a_sector_in_l2_flight_cost_one_dram_read) {
  build();
  read(0);
  read(0);
  drain(calendar);
  EXPECT_EQ(sink->arrived.size(), 2u);
  EXPECT_EQ(uut->counts().dram.reads, 1u);
  EXPECT_EQ(uut->counts().l2.merges[static_cast<std::size_t>(Traffic::kNode)], 1u);
  uut->check_drained();
}

TEST_F(Memory, data_from_dram_do_not_wait_for_a_hit_that_is_ready_later) {
  build();
  time(0);
  rest();
  const Cycles start = calendar.now();
  read(1024);
  // Looked up while the other is still at DRAM, ready after it.
  At later(calendar, start + Cycles{200}, [&](Cycles) { read(0); });
  drain(calendar);
  ASSERT_EQ(sink->arrived.size(), 3u);
  EXPECT_EQ(sink->arrived[1].second, Address{1024});
  EXPECT_EQ(sink->arrived[1].first, start + miss());
  EXPECT_EQ(sink->arrived[2].first, start + Cycles{200} + hit());
}

TEST_F(Memory, a_read_that_joins_a_miss_at_its_end_still_takes_the_way_of_a_hit) {
  build();
  const Cycles late = miss() - Cycles{20};
  time(config.dram.row.value);
  rest();
  const Cycles start = calendar.now();
  read(config.dram.row.value + 1024);
  At later(calendar, start + late, [&](Cycles) { read(config.dram.row.value + 1024); });
  drain(calendar);
  ASSERT_EQ(sink->arrived.size(), 3u);
  EXPECT_EQ(sink->arrived[1].first, start + miss());
  EXPECT_EQ(sink->arrived[2].first, start + late + hit());
  EXPECT_EQ(uut->counts().dram.reads, 2u);
}

TEST_F(Memory, full_l2_mshrs_delay_but_lose_nothing) {
  config.l2.mshrs = 1;
  build();
  for (std::uint64_t i = 0; i < 8; ++i) {
    read(i * 4096);
    read(i * 4096);
  }
  drain(calendar);
  EXPECT_EQ(sink->arrived.size(), 16u);
  EXPECT_GT(uut->counts().l2.mshr_full, 0u);
  uut->check_drained();
}

TEST_F(Memory, an_evicted_dirty_sector_is_written_to_dram) {
  config.l2.slice_capacity = Bytes{kLineBytes};
  config.l2.ways = 1;
  build();
  read(0, true);
  drain(calendar);
  EXPECT_EQ(uut->counts().dram.writes, 0u);
  time(kLineBytes);
  EXPECT_EQ(uut->counts().dram.writes, 1u);
  uut->check_drained();
}

TEST_F(Memory, neighbouring_chunks_go_to_different_slices) {
  config.l2.channels = 4;
  build();
  const Cycles start = calendar.now();
  for (std::uint64_t i = 0; i < 4; ++i) {
    read(i * config.l2.interleave.value);
  }
  drain(calendar);
  // Four channels work at the same time; only the ports to and from the SM order them.
  EXPECT_EQ(sink->arrived.back().first - start, miss() + config.dram.rcd + Cycles{3});
}

}  // namespace
}  // namespace a2rt::timing::test
