// The shipped machines parse, and table1 is what the code calls its defaults.
#include <gtest/gtest.h>

#include "a2rt/base/error.h"
#include "a2rt/config/section.h"
#include "a2rt/timing/machine_config.h"

namespace a2rt::timing {
namespace {

MachineConfig load(const std::string& name, const std::vector<std::string>& set = {}) {
  const auto section =
      config::Section::from_file(std::string(A2RT_GPU_FOLDER "/") + name + ".toml", set);
  MachineConfig c = MachineConfig::from_section(section);
  section.reject_unknown_keys();
  return c;
}

TEST(MachineConfig, table1_is_the_papers_table_i) {
  const MachineConfig c = load("table1");
  EXPECT_EQ(c.core_mhz, 1365u);
  EXPECT_EQ(c.sm.count, 8u);
  EXPECT_EQ(c.sm.warps, 32u);
  EXPECT_EQ(c.rt.warps, 4u);
  EXPECT_EQ(c.l1.capacity, Bytes{64 * 1024});
  EXPECT_EQ(c.l1.ways, 0u);
  EXPECT_EQ(c.l2.slice_capacity * c.l2.channels * c.l2.slices_per_channel, Bytes{3 << 20});
  EXPECT_EQ(c.l2.ways, 16u);
}

TEST(MachineConfig, the_defaults_in_code_are_table1) {
  const MachineConfig file = load("table1"), code;
  EXPECT_EQ(file.l1.latency, code.l1.latency);
  EXPECT_EQ(file.dram.cl, code.dram.cl);
  EXPECT_EQ(file.rt.stack_entries, code.rt.stack_entries);
  for (std::size_t t = 0; t < kTesters; ++t) {
    EXPECT_EQ(file.rt.testers[t].count, code.rt.testers[t].count) << t;
    EXPECT_EQ(file.rt.testers[t].latency, code.rt.testers[t].latency) << t;
    EXPECT_EQ(file.rt.testers[t].interval, code.rt.testers[t].interval) << t;
  }
}

TEST(MachineConfig, mobile_has_half_the_l1_and_a_sixth_of_the_l2) {
  const MachineConfig c = load("mobile");
  EXPECT_EQ(c.l1.capacity, Bytes{32 * 1024});
  EXPECT_EQ(c.l2.slice_capacity * c.l2.channels * c.l2.slices_per_channel, Bytes{512 * 1024});
  EXPECT_EQ(c.sm.count, 8u);
}

TEST(MachineConfig, a_misspelt_key_is_a_user_error) {
  EXPECT_THROW(load("table1", {"rt.stak_entries=4"}), UserError);
}

TEST(MachineConfig, what_the_model_cannot_run_is_refused_with_the_range_it_can) {
  for (const char* bad :
       {"rt.mhz=1366", "rt.mhz=170", "rt.stack_entry_bytes=33", "rt.stack_entry_bytes=0",
        "l1.mshrs=0", "rt.warps=65", "l2.interleave=192"}) {
    EXPECT_THROW(load("table1", {bad}), UserError) << bad;
  }
  EXPECT_EQ(load("table1", {"rt.mhz=171"}).rt.mhz, 171u);
  EXPECT_EQ(load("table1", {"rt.warps=64"}).rt.warps, 64u);
}

TEST(MachineConfig, overrides_reach_the_machine) {
  EXPECT_EQ(load("table1", {"rt.stack_entries=4"}).rt.stack_entries, 4u);
  EXPECT_EQ(load("table1", {"rt.context=refetch"}).rt.context, ContextPolicy::kRefetch);
}

}  // namespace
}  // namespace a2rt::timing
