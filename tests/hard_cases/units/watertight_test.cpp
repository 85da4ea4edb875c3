// No ray slips through a closed surface, be it aimed exactly at its vertices or edges.
#include "a2rt/hard/watertight.h"

#include <gtest/gtest.h>

namespace a2rt::hard {
namespace {

class ClosedMeshTest : public testing::TestWithParam<std::size_t> {
 protected:
  const ClosedMesh& mesh() const { return closed_meshes()[GetParam()]; }
};

TEST_P(ClosedMeshTest, NoRayLeaksForUnitsThatNeverMiss) {
  const Workload workload = mesh().make(6);
  EXPECT_GT(workload.rays.size(), 70000U);
  for (const UnitColumn& column : unit_columns()) {
    if (make_unit(column)->info().promise != Promise::kMayMiss) {
      const Leaks leaks = count_leaks(column, workload);
      EXPECT_EQ(leaks.leaked, 0U) << column.key << " of " << leaks.rays;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, ClosedMeshTest, testing::Range(std::size_t{0}, std::size_t{4}),
                         [](const auto& i) { return closed_meshes()[i.param].key; });

TEST(ClosedMesh, OurOwnRaysWouldShowAHole) {
  Workload workload = closed_meshes()[0].make(2);
  workload.blas[0].triangles.resize(workload.blas[0].triangles.size() - 40);
  workload.blas[0].geometries[0].count -= 40;
  EXPECT_GT(count_leaks(unit_column("baseline"), workload).leaked, 0U);
}

TEST(ClosedMesh, TheCubeLeaksUnderAqb8AndUnderA2rtAsPrinted) {
  for (const ClosedMesh& mesh : closed_meshes()) {
    if (mesh.key == "cube") {
      const Workload workload = mesh.make(6);
      EXPECT_GT(count_leaks(unit_column("aqb8_floor"), workload).leaked, 0U);
      EXPECT_GT(count_leaks(unit_column("aqb8_nearest"), workload).leaked, 0U);
      EXPECT_GT(count_leaks(unit_column("a2rt_literal"), workload).leaked, 0U);
    }
  }
}

}  // namespace
}  // namespace a2rt::hard
