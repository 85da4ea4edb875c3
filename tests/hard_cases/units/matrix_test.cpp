// The whole matrix, a test a cell: no unit that promises it misses anything in any hard case, and
// each unit that fails does so in the documented cases, by the documented mechanism, and nowhere
// else.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "a2rt/hard/judge.h"
#include "a2rt/hard/views.h"

namespace a2rt::hard {
namespace {

const char* const kZero = "zero direction component: slope taken as 1";
const char* const kShift = "5-bit shift overflows 32 bits (|d| < 2^-16)";
const char* const kWrap = "5-bit exponent wraps (|d| <= 2^-32)";
const char* const kCancel = "FP32 cancellation";
const char* const kAnchor = "anchor test: unpadded FP32";
const char* const kClamp =
    "origin clamped to the group's range, or plain FP32 rounding of shift and scale";
const char* const kGroup = "group test: unpadded FP32";

struct Failure {
  const char* row;
  std::vector<const char*> mechanisms;
};

// AQB8 in both roundings. The rows on origins, intervals and scenes hold axis-parallel rays.
const std::vector<Failure> kAqb8Failures{{"axis_parallel", {kZero}},
                                         {"nearer_axis", {kShift}},
                                         {"tiny_direction", {kWrap}},
                                         {"denormal_direction", {kWrap, kZero}},
                                         {"zero_direction", {kZero}},
                                         {"flat", {kZero}},
                                         {"in_plane", {kZero}},
                                         {"points", {kZero}},
                                         {"coincident", {kZero, kAnchor}},
                                         {"nested", {kZero, kCancel, kAnchor}},
                                         {"origin_inside", {kZero}},
                                         {"origin_on_face", {kZero}},
                                         {"origin_on_edge", {kZero}},
                                         {"origin_on_corner", {kZero}},
                                         {"origin_far", {kCancel, kAnchor}},
                                         {"offset", {kCancel, kAnchor}},
                                         {"tmax", {kZero}},
                                         {"tmin", {kZero}},
                                         {"tmin_tmax", {kZero}},
                                         {"inactive", {kZero}},
                                         {"ties", {kZero}},
                                         {"mirrored", {kZero}},
                                         {"sheared", {kZero}},
                                         {"singular", {kZero, kShift}}};
// Its step is zero or infinite: it cannot encode such groups.
const std::vector<std::string> kAqb8Refuses{"denormal_extent", "huge_extent"};

const std::vector<Failure> kLiteralFailures{
    {"axis_parallel", {kGroup}},  {"nearer_axis", {kClamp}},
    {"unnormalized", {kGroup}},   {"flat", {kGroup}},
    {"huge_extent", {kClamp}},    {"points", {kGroup}},
    {"slivers", {kGroup}},        {"coincident", {kGroup}},
    {"nested", {kClamp, kGroup}}, {"origin_far", {kClamp, kGroup}},
    {"offset", {kClamp}},         {"singular", {kClamp}}};

const Failure* documented(const std::string& row, const std::string& column) {
  const std::vector<Failure>* list = column == "a2rt_literal"     ? &kLiteralFailures
                                     : column.starts_with("aqb8") ? &kAqb8Failures
                                                                  : nullptr;
  if (list == nullptr) {
    return nullptr;
  }
  const auto found =
      std::find_if(list->begin(), list->end(), [&](const Failure& f) { return row == f.row; });
  return found == list->end() ? nullptr : &*found;
}

bool refuses(const std::string& row, const std::string& column) {
  return column.starts_with("aqb8") &&
         std::find(kAqb8Refuses.begin(), kAqb8Refuses.end(), row) != kAqb8Refuses.end();
}

struct CellName {
  std::string row, column;
};
std::ostream& operator<<(std::ostream& out, const CellName& cell) {
  return out << cell.row << ", " << cell.column;
}

std::vector<CellName> all_cells() {
  std::vector<CellName> cells;
  for (const HardCase& row : hard_cases()) {
    for (const UnitColumn& column : unit_columns()) {
      cells.push_back({row.key, column.key});
    }
  }
  return cells;
}

std::uint64_t by_mechanism(const Audit& audit, const std::string& mechanism) {
  std::uint64_t count = 0;
  for (const auto& [name, missed] : audit.missed_by_mechanism) {
    count += name.starts_with(mechanism) ? missed : 0;
  }
  return count;
}

void expect_pictures(const std::map<std::string, std::uint64_t>& mechanisms) {
  for (const auto& one : mechanisms) {
    EXPECT_TRUE(std::any_of(views().begin(), views().end(),
                            [&](const View& view) { return view.mechanism == one.first; }))
        << "no picture shows: " << one.first;
  }
}

class HardCaseTest : public testing::TestWithParam<CellName> {};

TEST_P(HardCaseTest, EndsAsDocumented) {
  const auto& [row, column] = GetParam();
  const Workload workload = hard_case(row).make();
  const Cell cell = judge(unit_column(column), workload, true_hits(workload));
  if (refuses(row, column)) {
    EXPECT_EQ(cell.verdict(), Verdict::kRefuses);
    EXPECT_NE(cell.refusal.find("BLAS 0"), std::string::npos) << "names the structure";
    EXPECT_NE(cell.refusal.find("node 0"), std::string::npos) << "names the node";
    return;
  }
  ASSERT_EQ(cell.refusal, "");
  EXPECT_GT(cell.audit.exact_hits + cell.audit.fp32_exact_hits, 0U) << "nothing was tested";
  std::uint64_t traced = 0;
  for (const auto& [mechanism, count] : cell.audit.missed_by_mechanism) {
    traced += count;
  }
  EXPECT_EQ(traced, cell.missed()) << "every miss has a mechanism";
  expect_pictures(cell.audit.missed_by_mechanism);
  expect_pictures(cell.lost_by_mechanism);
  const Failure* failure = documented(row, column);
  if (failure == nullptr) {
    EXPECT_EQ(cell.missed(), 0U) << (traced == 0 ? ""
                                                 : cell.audit.missed_by_mechanism.begin()->first);
    EXPECT_EQ(cell.lost, 0U);
    return;
  }
  EXPECT_EQ(cell.verdict(), Verdict::kMisses);
  std::uint64_t explained = 0;
  for (const char* mechanism : failure->mechanisms) {
    EXPECT_GT(by_mechanism(cell.audit, mechanism), 0U) << mechanism;
    explained += by_mechanism(cell.audit, mechanism);
  }
  EXPECT_EQ(explained, cell.missed()) << "a mechanism that is not documented";
}

INSTANTIATE_TEST_SUITE_P(Units, HardCaseTest, testing::ValuesIn(all_cells()), [](const auto& cell) {
  return cell.param.row + "_IN_" + cell.param.column;
});

TEST(HardCases, TheUnitsThatPromiseItAreTheOnesWithoutDocumentedFailures) {
  for (const UnitColumn& column : unit_columns()) {
    const bool promises = make_unit(column)->info().promise != Promise::kMayMiss;
    const bool fails = std::any_of(
        hard_cases().begin(), hard_cases().end(),
        [&](const HardCase& row) { return documented(row.key, column.key) != nullptr; });
    EXPECT_NE(promises, fails) << column.key;
  }
}

TEST(HardCases, EveryDocumentedFailureNamesACase) {
  for (const auto* list : {&kAqb8Failures, &kLiteralFailures}) {
    for (const Failure& failure : *list) {
      EXPECT_NO_THROW(hard_case(failure.row));
    }
  }
}

TEST(HardCases, ACaseIsTheSameEveryTime) {
  for (const HardCase& row : hard_cases()) {
    const Workload a = row.make(), b = row.make();
    ASSERT_EQ(a.rays.size(), b.rays.size());
    EXPECT_EQ(true_hits(a).size(), a.rays.size());
    EXPECT_EQ(a.blas.size(), b.blas.size()) << row.key;
  }
}

}  // namespace
}  // namespace a2rt::hard
