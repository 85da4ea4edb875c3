// Same counts and same area, by the table.
#include "a2rt/energy/fair_testers.h"

#include <gtest/gtest.h>

#include "a2rt/base/error.h"
#include "a2rt/energy/qbox_area.h"

namespace a2rt::energy {
namespace {

using timing::Tester;

struct FairTesters : ::testing::Test {
  EnergyTable table = EnergyTable::from_file(A2RT_ENERGY_FOLDER "/12nm.csv");
  timing::MachineConfig machine;
  TesterArea apply(Comparison c, Design d) {
    return apply_comparison(c, d, engine_area_um2(table), table, machine);
  }
  std::uint32_t count(Tester t) const { return machine.rt.tester(t).count; }
};

TEST_F(FairTesters, a2rt_is_table_2_in_both_comparisons) {
  for (const Comparison c : {Comparison::kSameCount, Comparison::kSameArea}) {
    const TesterArea area = apply(c, Design::kA2rt);
    EXPECT_EQ(count(Tester::kQBox), 120u);
    EXPECT_EQ(count(Tester::kBox), 15u);
    EXPECT_EQ(count(Tester::kQuantizer), 15u);
    EXPECT_EQ(count(Tester::kAnchor), 0u);
    EXPECT_DOUBLE_EQ(area.used_um2, area.reference_um2);
  }
}

TEST_F(FairTesters, same_count_gives_fp32_as_many_box_testers_as_a2rt_has_in_all) {
  apply(Comparison::kSameCount, Design::kFp32);
  EXPECT_EQ(count(Tester::kBox), 135u);
  EXPECT_EQ(count(Tester::kQBox), 0u);
}

TEST_F(FairTesters, same_area_is_filled_but_not_exceeded) {
  const TesterArea fp32 = apply(Comparison::kSameArea, Design::kFp32);
  EXPECT_LE(fp32.used_um2, fp32.reference_um2);
  EXPECT_GT(fp32.used_um2 + table.area_um2("box"), fp32.reference_um2);
  const TesterArea aqb8 = apply(Comparison::kSameArea, Design::kAqb8);
  EXPECT_LE(aqb8.used_um2, aqb8.reference_um2);
  EXPECT_GT(aqb8.used_um2 + table.area_um2("qbox_aqb8"), aqb8.reference_um2);
  EXPECT_EQ(count(Tester::kAnchor), 15u);
  EXPECT_EQ(count(Tester::kUpdate), 15u);
}

TEST_F(FairTesters, all_designs_fill_the_area_of_the_a2rt_as_configured_and_no_other) {
  arith::A2rtPrecision wide = published_precision();
  wide.origin = arith::OriginDesign::kWide;
  const EnergyTable scaled = for_precision(table, wide);
  const double yardstick = engine_area_um2(scaled);
  ASSERT_GT(yardstick, engine_area_um2(table));
  const TesterArea a2rt =
      apply_comparison(Comparison::kSameArea, Design::kA2rt, yardstick, scaled, machine);
  EXPECT_EQ(count(Tester::kQBox), 120u);
  EXPECT_DOUBLE_EQ(a2rt.used_um2, yardstick);
  for (const Design other : {Design::kFp32, Design::kCompressed, Design::kAqb8}) {
    const TesterArea area =
        apply_comparison(Comparison::kSameArea, other, yardstick, table, machine);
    EXPECT_LE(area.used_um2, yardstick);
    EXPECT_GT(area.used_um2 + table.area_um2("box") + table.area_um2("dequantizer"), yardstick);
  }
  // A cheaper A2RT gets more testers for the same area.
  apply_comparison(Comparison::kSameArea, Design::kA2rt, yardstick, table, machine);
  EXPECT_GT(count(Tester::kQBox), 120u);
}

TEST_F(FairTesters, compressed_fp32_designs_pay_for_their_dequantizers) {
  apply(Comparison::kSameArea, Design::kFp32);
  const std::uint32_t plain = count(Tester::kBox);
  apply(Comparison::kSameArea, Design::kCompressed);
  EXPECT_LT(count(Tester::kBox), plain);
  EXPECT_EQ(count(Tester::kDequantize), count(Tester::kBox));
}

TEST_F(FairTesters, config_leaves_the_machine_as_it_is) {
  machine.rt.tester(Tester::kBox).count = 77;
  const TesterArea area = apply(Comparison::kConfig, Design::kFp32);
  EXPECT_EQ(count(Tester::kBox), 77u);
  // The machine's other testers are not the design's.
  EXPECT_DOUBLE_EQ(area.used_um2, 77 * table.area_um2("box"));
}

TEST_F(FairTesters, an_unknown_comparison_is_a_user_error) {
  EXPECT_EQ(comparison_of("same-area"), Comparison::kSameArea);
  EXPECT_THROW(comparison_of("same-price"), UserError);
}

}  // namespace
}  // namespace a2rt::energy
