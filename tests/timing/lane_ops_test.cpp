// What a ray's events become before the RT unit replays them.
#include "a2rt/timing/lane_ops.h"

#include <gtest/gtest.h>

#include "mocks.h"

namespace a2rt::timing {
namespace {

using Code = LaneOp::Code;
using test::count_event;
using test::fetch;

struct Compiled {
  LaneOps ops;
  LaneOpCounts counts;
  std::vector<Code> codes() const {
    std::vector<Code> all;
    for (std::size_t i = 0; i < ops.size(); ++i) {
      all.push_back(ops[i].code());
    }
    return all;
  }
};

constexpr Address kSpill{std::uint64_t{1} << 44};

Compiled compile(const std::vector<Event>& events, const RtConfig& config = {}) {
  Compiled c;
  LaneCompiler uut(config);
  uut.compile(events, kSpill, c.ops);
  c.counts = uut.counts();
  return c;
}

TEST(LaneOps, a_ray_without_events_ends_at_once) {
  EXPECT_EQ(compile({}).codes(), std::vector<Code>{Code::kEnd});
}

TEST(LaneOps, a_record_over_two_lines_is_one_read_that_ends_with_the_second) {
  const Compiled c = compile({fetch(100, 45, Traffic::kGroupNode)});
  ASSERT_EQ(c.codes(), (std::vector<Code>{Code::kRead, Code::kRead, Code::kEnd}));
  EXPECT_EQ(c.ops[0].line(), 0u);
  EXPECT_EQ(c.ops[0].sectors(), 0b1000);
  EXPECT_FALSE(c.ops[0].last());
  EXPECT_EQ(c.ops[1].line(), 1u);
  EXPECT_EQ(c.ops[1].sectors(), 0b0001);
  EXPECT_EQ(c.ops[1].kind(), Traffic::kGroupNode);
  EXPECT_TRUE(c.ops[1].last());
  EXPECT_EQ(c.counts.fetches[static_cast<std::size_t>(Traffic::kGroupNode)], 1u);
  EXPECT_EQ(c.counts.fetch_bytes[static_cast<std::size_t>(Traffic::kGroupNode)], 45u);
}

TEST(LaneOps, records_that_touch_are_one_read_and_others_are_not) {
  const Compiled c = compile({fetch(0, 48), fetch(48, 16, Traffic::kTriangle), fetch(96)});
  ASSERT_EQ(c.ops.size(), 4u);
  EXPECT_FALSE(c.ops[0].last());
  EXPECT_TRUE(c.ops[1].last());
  EXPECT_EQ(c.ops[1].kind(), Traffic::kTriangle);
  EXPECT_TRUE(c.ops[2].last());
  EXPECT_EQ(c.counts.events[static_cast<std::size_t>(EventKind::kFetch)], 3u);
}

TEST(LaneOps, a_line_as_far_as_the_spilled_stacks_keeps_its_number) {
  const std::uint64_t far = (std::uint64_t{1} << 53) + 4096;
  EXPECT_EQ(compile({fetch(far)}).ops[0].line(), far / kLineBytes);
  EXPECT_THROW(compile({fetch(std::uint64_t{1} << 54)}), InternalError);
}

TEST(LaneOps, boxes_of_both_kinds_start_together_and_empty_tests_take_no_tester) {
  const Compiled c =
      compile({count_event(EventKind::kBoxTest, 3), count_event(EventKind::kQBoxTest, 2),
               count_event(EventKind::kQBoxTest, 4), count_event(EventKind::kTriangleTest, 0)});
  ASSERT_EQ(c.codes(), (std::vector<Code>{Code::kTestPair, Code::kTest, Code::kEnd}));
  EXPECT_EQ(c.ops[0].count(), 3u);
  EXPECT_EQ(c.ops[0].second(), 2u);
  EXPECT_EQ(c.ops[1].tester(), Tester::kQBox);
  EXPECT_EQ(c.counts.events[static_cast<std::size_t>(EventKind::kTriangleTest)], 1u);
}

TEST(LaneOps, a_result_is_stored_sector_by_sector) {
  const Compiled c = compile({fetch(120, 16, Traffic::kResult)});
  ASSERT_EQ(c.codes(), (std::vector<Code>{Code::kStore, Code::kStore, Code::kEnd}));
  EXPECT_EQ(c.ops[0].sectors(), 0b1000);
  EXPECT_EQ(c.ops[1].line(), 1u);
  EXPECT_EQ(c.ops[1].sectors(), 0b0001);
}

TEST(LaneOps, a_context_comes_from_its_stack_or_is_read_and_set_up_again) {
  const Event group{EventKind::kContextPop, Traffic::kGroupNode, 1, 45, 8192};
  const Event anchor{EventKind::kContextPop, Traffic::kAnchor, 1, 45, 8192};
  EXPECT_EQ(compile({group}).codes(), (std::vector<Code>{Code::kPopContext, Code::kEnd}));
  const Compiled again = compile({group}, ContextPolicy::kRefetch);
  ASSERT_EQ(again.codes(), (std::vector<Code>{Code::kRefetchContext, Code::kRead, Code::kTest,
                                              Code::kTest, Code::kEnd}));
  EXPECT_EQ(again.ops[2].tester(), Tester::kBox);
  EXPECT_EQ(again.ops[3].tester(), Tester::kQuantizer);
  const Compiled cluster = compile({anchor}, ContextPolicy::kRefetch);
  ASSERT_EQ(cluster.codes(),
            (std::vector<Code>{Code::kRefetchContext, Code::kRead, Code::kTest, Code::kEnd}));
  EXPECT_EQ(cluster.ops[2].tester(), Tester::kAnchor);
}

}  // namespace
}  // namespace a2rt::timing
