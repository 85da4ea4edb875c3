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
  uut.begin(kSpill, c.ops);
  send(events, uut);
  uut.end();
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
  const Compiled c = compile({fetch(0, 128), fetch(128, 16, Traffic::kTriangle), fetch(256)});
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

RtConfig with(ContextPolicy policy) {
  RtConfig config;
  config.context = policy;
  return config;
}

TEST(LaneOps, a_context_comes_from_its_stack_or_is_read_and_set_up_again) {
  const Event save = count_event(EventKind::kContextPush);
  const Event group{EventKind::kContextPop, Traffic::kGroupNode, 1, 45, 8192};
  const Event anchor{EventKind::kContextPop, Traffic::kAnchor, 1, 45, 8192};
  const Compiled kept = compile({save, group});
  EXPECT_EQ(kept.codes(), std::vector<Code>{Code::kEnd});
  EXPECT_EQ(kept.counts.context_saves, 1u);
  EXPECT_EQ(kept.counts.context_restores, 1u);
  const Compiled again = compile({save, group}, with(ContextPolicy::kRefetch));
  ASSERT_EQ(again.codes(), (std::vector<Code>{Code::kRead, Code::kTest, Code::kTest, Code::kEnd}));
  EXPECT_EQ(again.ops[1].tester(), Tester::kBox);
  EXPECT_EQ(again.ops[2].tester(), Tester::kQuantizer);
  EXPECT_EQ(again.counts.context_refetches, 1u);
  EXPECT_EQ(again.counts.context_refetch_steps, 2u);
  const Compiled cluster = compile({save, anchor}, with(ContextPolicy::kRefetch));
  ASSERT_EQ(cluster.codes(), (std::vector<Code>{Code::kRead, Code::kTest, Code::kEnd}));
  EXPECT_EQ(cluster.ops[1].tester(), Tester::kAnchor);
}

TEST(LaneOps, a_context_that_was_never_saved_cannot_come_back) {
  const Event group{EventKind::kContextPop, Traffic::kGroupNode, 1, 45, 8192};
  EXPECT_THROW(compile({group}), InternalError);
  EXPECT_THROW(compile({group}, with(ContextPolicy::kRefetch)), InternalError);
  EXPECT_THROW(compile({count_event(EventKind::kContextPop, 0)}), InternalError);
}

TEST(LaneOps, a_context_forgotten_counts_as_no_restoring) {
  const Compiled c =
      compile({count_event(EventKind::kContextPush), count_event(EventKind::kContextPop, 0)});
  EXPECT_EQ(c.counts.events[static_cast<std::size_t>(EventKind::kContextPop)], 0u);
  EXPECT_EQ(c.counts.context_restores, 0u);
}

TEST(LaneOps, a_stack_within_its_depth_leaves_no_operation_behind) {
  const Compiled c = compile({count_event(EventKind::kPush, 8), count_event(EventKind::kPop),
                              count_event(EventKind::kPush), count_event(EventKind::kPop, 8)});
  EXPECT_EQ(c.codes(), std::vector<Code>{Code::kEnd});
  EXPECT_EQ(c.counts.stack_pushed, 9u);
  EXPECT_EQ(c.counts.stack_popped, 9u);
  EXPECT_EQ(c.counts.stack_spills, 0u);
}

TEST(LaneOps, the_oldest_entries_leave_for_the_lanes_memory_and_come_back_last) {
  // Nine entries of eight bytes: the oldest four make room and return when the five are gone.
  std::vector<Event> events = {count_event(EventKind::kPush, 9)};
  events.insert(events.end(), 9, count_event(EventKind::kPop));
  const Compiled c = compile(events);
  ASSERT_EQ(c.codes(), (std::vector<Code>{Code::kStore, Code::kRead, Code::kEnd}));
  for (std::size_t op = 0; op < 2; ++op) {
    EXPECT_EQ(c.ops[op].line(), line_of(kSpill));
    EXPECT_EQ(c.ops[op].sectors(), 0b0001);
    EXPECT_EQ(c.ops[op].kind(), Traffic::kStack);
  }
  EXPECT_TRUE(c.ops[1].last());
  EXPECT_EQ(c.counts.stack_spilled, 4u);
  EXPECT_EQ(c.counts.stack_filled, 4u);
  EXPECT_EQ(c.counts.fetches[static_cast<std::size_t>(Traffic::kStack)], 1u);
}

TEST(LaneOps, contexts_beyond_those_on_chip_lie_in_the_upper_half_of_the_lanes_memory) {
  RtConfig config;
  config.context_entries = 1;
  const Event save = count_event(EventKind::kContextPush);
  const Event group{EventKind::kContextPop, Traffic::kGroupNode, 1, 45, 8192};
  const Compiled c = compile({save, save, group, group}, config);
  ASSERT_EQ(c.codes(), (std::vector<Code>{Code::kStore, Code::kRead, Code::kEnd}));
  EXPECT_EQ(c.ops[0].line(), line_of(kSpill + Bytes{kSpillBytesPerLane / 2}));
  EXPECT_EQ(c.ops[1].line(), c.ops[0].line());
}

TEST(LaneOps, a_ray_that_pops_more_than_it_pushed_is_refused) {
  EXPECT_THROW(compile({count_event(EventKind::kPush), count_event(EventKind::kPop, 2)}),
               InternalError);
}

TEST(LaneOps, records_that_share_a_line_ask_for_it_once_and_for_each_sector_once) {
  const Compiled c = compile({fetch(0, 48), fetch(48, 48, Traffic::kTriangle)});
  ASSERT_EQ(c.codes(), (std::vector<Code>{Code::kRead, Code::kEnd}));
  EXPECT_EQ(c.ops[0].sectors(), 0b0111);
  EXPECT_TRUE(c.ops[0].last());
  // The sector both records lie in is the first one's.
  EXPECT_EQ(c.counts.sectors_wanted[static_cast<std::size_t>(Traffic::kNode)], 2u);
  EXPECT_EQ(c.counts.sectors_wanted[static_cast<std::size_t>(Traffic::kTriangle)], 1u);
}

// A context's record of 45 B at `begin` is read again; records at its end go on with it.
struct Continued {
  std::uint64_t begin;
  std::vector<SectorMask> lines;  // from 64 on
  std::uint64_t first, second;    // sectors wanted
};

TEST(LaneOps, what_touches_a_record_read_again_belongs_to_its_read_and_its_tests_wait_for_all) {
  const Event save = count_event(EventKind::kContextPush);
  for (const Continued& at : {Continued{8192, {0b0111}, 2, 1},               // in the same line
                              Continued{8192 + 80, {0b1100, 0b0011}, 2, 2},  // into the next one
                              Continued{8192 + 83, {0b1100, 0b0011}, 2, 2},  // all in the next one
                              Continued{8192 + 90, {0b1100, 0b0011}, 3, 1}}) {
    for (const Traffic kind : {Traffic::kAnchor, Traffic::kGroupNode}) {
      const Event again{EventKind::kContextPop, kind, 1, 45, at.begin};
      const Compiled c = compile({save, again, fetch(at.begin + 45, 45, Traffic::kTriangle),
                                  count_event(EventKind::kTriangleTest)},
                                 with(ContextPolicy::kRefetch));
      const std::vector<Tester> testers =
          kind == Traffic::kAnchor
              ? std::vector{Tester::kAnchor, Tester::kTriangle}
              : std::vector{Tester::kBox, Tester::kQuantizer, Tester::kTriangle};
      ASSERT_EQ(c.ops.size(), at.lines.size() + testers.size() + 1);
      for (std::size_t i = 0; i < at.lines.size(); ++i) {
        EXPECT_EQ(c.ops[i].code(), Code::kRead);
        EXPECT_EQ(c.ops[i].line(), 64 + i);
        EXPECT_EQ(c.ops[i].sectors(), at.lines[i]);
        EXPECT_EQ(c.ops[i].last(), i + 1 == at.lines.size());
      }
      for (std::size_t i = 0; i < testers.size(); ++i) {
        EXPECT_EQ(c.ops[at.lines.size() + i].code(), Code::kTest);
        EXPECT_EQ(c.ops[at.lines.size() + i].tester(), testers[i]);
      }
      EXPECT_EQ(c.codes().back(), Code::kEnd);
      const auto k = static_cast<std::size_t>(kind);
      const auto more = static_cast<std::size_t>(Traffic::kTriangle);
      EXPECT_EQ(c.counts.fetches[k], 1u);
      EXPECT_EQ(c.counts.fetches[more], 1u);
      EXPECT_EQ(c.counts.fetch_bytes[k], 45u);
      EXPECT_EQ(c.counts.fetch_bytes[more], 45u);
      EXPECT_EQ(c.counts.sectors_wanted[k], at.first);
      EXPECT_EQ(c.counts.sectors_wanted[more], at.second);
      EXPECT_EQ(c.counts.context_refetches, 1u);
      EXPECT_EQ(c.counts.context_refetch_steps, testers.size() - 1);
    }
  }
}

}  // namespace
}  // namespace a2rt::timing
