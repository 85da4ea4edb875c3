// Memory in the model "reserved" against the model "queued": what is alone takes the same cycles.
#include "a2rt/timing/reserved_memory.h"

#include <gtest/gtest.h>

#include <random>

#include "a2rt/timing/memory_system.h"
#include "mocks.h"

namespace a2rt::timing::test {
namespace {

class LastFill final : public LineSink {
 public:
  void fill(Cycles first, Address, SectorMask sectors) override {
    last = std::max(last, first + Cycles{sectors_in(sectors) - 1});
  }
  Cycles last;
};

// One read after the other, each long after the one before.
class Alone : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  MachineConfig config = one_sm();
  Calendar calendar;
  LastFill sink;
  Alone() {
    config.dram.mhz = GetParam();
    config.l2.slice_capacity = Bytes{4096};
    config.l2.channels = 2;
  }
};

TEST_P(Alone, a_read_takes_as_long_as_if_it_went_through_queues) {
  MemorySystem queued(config, calendar, calendar);
  queued.connect(0, sink, calendar);
  ReservedMemory reserved(config);
  std::mt19937_64 random(11);
  for (int i = 0; i < 2000; ++i) {
    At idle(calendar, calendar.now() + Cycles{5000}, [](Cycles) {});
    drain(calendar);
    const Cycles now = calendar.now();
    const Address line{random() % 2000 * kLineBytes};
    const auto sector = static_cast<SectorMask>(1u << random() % 4);
    queued.request(now, 0, line, sector, Traffic::kNode, false);
    drain(calendar);
    reserved.begin_stretch(now);
    ASSERT_EQ(reserved.read(now, 0, line, sector, Traffic::kNode), sink.last) << i;
  }
  const MemoryCounts a = reserved.counts(), b = queued.counts();
  EXPECT_EQ(a.l2.hits, b.l2.hits);
  EXPECT_EQ(a.l2.misses, b.l2.misses);
  EXPECT_EQ(a.dram.row_hits, b.dram.row_hits);
  EXPECT_EQ(a.dram.row_misses, b.dram.row_misses);
  EXPECT_EQ(a.dram.row_conflicts, b.dram.row_conflicts);
  EXPECT_GT(a.dram.row_conflicts, 0u);
  EXPECT_GT(a.l2.evictions, 0u);
  reserved.check_drained();
}

INSTANTIATE_TEST_SUITE_P(Clocks, Alone, ::testing::Values(1365u, 2730u));

struct Reserved : ::testing::Test {
  MachineConfig config = one_sm();
  Cycles read(ReservedMemory& uut, std::uint64_t now, std::uint64_t line, SectorMask sectors = 1) {
    return uut.read(Cycles{now}, 0, Address{line * kLineBytes}, sectors, Traffic::kNode);
  }
};

TEST_F(Reserved, who_asks_for_what_is_on_its_way_gets_it_when_it_comes) {
  ReservedMemory uut(config);
  const Cycles first = read(uut, 0, 0);
  EXPECT_EQ(read(uut, 40, 0), first + Cycles{1});  // one link
  EXPECT_EQ(uut.counts().dram.reads, 1u);
  EXPECT_EQ(uut.counts().l2.merges[static_cast<std::size_t>(Traffic::kNode)], 1u);
}

TEST_F(Reserved, an_open_row_delivers_a_sector_every_burst) {
  config.dram.mhz = config.core_mhz;
  config.l2.channels = config.l2.slices_per_channel = 1;
  ReservedMemory uut(config);
  std::vector<Cycles> there;
  for (std::uint64_t line = 0; line < 16; ++line) {
    there.push_back(read(uut, 0, line, 0xf));
  }
  // 16 lines of 4 sectors; the first comes after its own four.
  EXPECT_EQ(there.back() - there.front(), config.dram.burst * (15 * 4));
  EXPECT_EQ(uut.counts().dram.activates, 1u);
}

TEST_F(Reserved, a_slice_has_no_more_misses_under_way_than_mshrs) {
  config.l2.mshrs = 1;
  config.l2.channels = config.l2.slices_per_channel = 1;
  ReservedMemory uut(config);
  const Cycles first = read(uut, 0, 0);
  EXPECT_GE(read(uut, 0, 64), first + config.dram.extra_latency);
  EXPECT_EQ(uut.counts().l2.mshr_full, 1u);
}

TEST_F(Reserved, what_is_written_and_thrown_out_goes_to_dram_with_its_kind) {
  config.l2.slice_capacity = Bytes{16 * kLineBytes};
  config.l2.channels = config.l2.slices_per_channel = 1;
  ReservedMemory uut(config);
  for (std::uint64_t line = 0; line < 17; ++line) {
    uut.request(Cycles{line * 100}, 0, Address{line * kLineBytes}, 0b0011, Traffic::kShader, true);
  }
  const MemoryCounts c = uut.counts();
  EXPECT_EQ(c.l2.writes[static_cast<std::size_t>(Traffic::kShader)], 34u);
  EXPECT_EQ(c.dram_writes[static_cast<std::size_t>(Traffic::kShader)], 2u);
  EXPECT_EQ(c.dram.writes, 2u);
  uut.check_drained();
}

TEST_F(Reserved, a_read_that_is_not_answered_at_once_is_refused) {
  ReservedMemory uut(config);
  EXPECT_THROW(uut.request(Cycles{0}, 0, Address{0}, 1, Traffic::kNode, false), InternalError);
}

}  // namespace
}  // namespace a2rt::timing::test
