// The estimated tester's area moves with every knob that changes its datapath, the right way.
#include "a2rt/energy/qbox_area.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "a2rt/base/error.h"

namespace a2rt::energy {
namespace {

using arith::A2rtPrecision;

double scale(const std::function<void(A2rtPrecision&)>& change) {
  A2rtPrecision precision;
  change(precision);
  return qbox_scale(precision);
}

EnergyTable shipped() { return EnergyTable::from_file(A2RT_ENERGY_FOLDER "/12nm.csv"); }

TEST(QBoxArea, ThePublishedPrecisionHasThePublishedArea) {
  EXPECT_DOUBLE_EQ(qbox_scale(published_precision()), 1);
  const EnergyTable table = for_precision(shipped(), published_precision());
  EXPECT_DOUBLE_EQ(table.area_um2("qbox_a2rt"), 973.53);
  EXPECT_EQ(table.find("qbox_a2rt", "test").note, Note::kPublished);
}

TEST(QBoxArea, EveryBoxBitCostsArea) {
  for (int bits = 4; bits < 12; ++bits) {
    EXPECT_LT(scale([&](A2rtPrecision& p) { p.box_bits = bits; }),
              scale([&](A2rtPrecision& p) { p.box_bits = bits + 1; }))
        << bits;
  }
}

TEST(QBoxArea, EveryColumnDroppedSavesArea) {
  for (const auto mode : {arith::LowColumns::kCompress, arith::LowColumns::kDrop}) {
    for (int k = 1; k < 8; ++k) {
      const auto with = [&](int columns) {
        return scale([&](A2rtPrecision& p) {
          p.low_columns = mode;
          p.multiplier_columns = columns;
        });
      };
      EXPECT_GT(with(k), with(k + 1)) << k;
    }
  }
}

TEST(QBoxArea, WiderDirectionsAndOriginsCostArea) {
  const auto direction = [](const std::string& name) {
    return scale([&](A2rtPrecision& p) { p.direction = arith::float_format_from(name); });
  };
  const std::vector<std::string> widening{"s5", "s6", "s7", "bf16", "s9", "s10", "fp32"};
  for (std::size_t i = 0; i + 1 < widening.size(); ++i) {
    EXPECT_LT(direction(widening[i]), direction(widening[i + 1])) << widening[i];
  }
  const double guard = scale([](A2rtPrecision& p) { p.origin = arith::OriginDesign::kGuard; });
  EXPECT_LT(guard, scale([](A2rtPrecision&) {}));
  EXPECT_LT(scale([](A2rtPrecision&) {}), scale([](A2rtPrecision& p) { p.origin_bits = 13; }));
}

TEST(QBoxArea, ScaledRowsAreMarkedEstimatedAndOthersStay) {
  const EnergyTable before = shipped(), after = for_precision(before, A2rtPrecision{});
  const Row& row = after.find("qbox_a2rt", "test");
  EXPECT_EQ(row.note, Note::kEstimated);
  EXPECT_NE(row.source.find("unit gates"), std::string::npos);
  const double factor = qbox_scale(A2rtPrecision{});
  EXPECT_GT(factor, 1);  // 10-bit origins
  EXPECT_DOUBLE_EQ(row.energy_pj, factor * before.find("qbox_a2rt", "test").energy_pj);
  EXPECT_DOUBLE_EQ(row.leak_uw, factor * before.leak_uw("qbox_a2rt"));
  EXPECT_DOUBLE_EQ(after.area_um2("box"), before.area_um2("box"));
  EXPECT_THROW(before.scaled("no_such", 2, "x"), UserError);
}

}  // namespace
}  // namespace a2rt::energy
