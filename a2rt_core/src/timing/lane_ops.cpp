#include "a2rt/timing/lane_ops.h"

#include <algorithm>
#include <utility>

#include "a2rt/base/error.h"

namespace a2rt::timing {
namespace {

// The tester an event goes to; kCount if it is not a test.
constexpr auto kTesterOf = [] {
  std::array<Tester, static_cast<std::size_t>(EventKind::kCount)> testers{};
  testers.fill(Tester::kCount);
  const auto set = [&](EventKind kind, Tester tester) {
    testers[static_cast<std::size_t>(kind)] = tester;
  };
  set(EventKind::kBoxTest, Tester::kBox);
  set(EventKind::kQBoxTest, Tester::kQBox);
  set(EventKind::kTriangleTest, Tester::kTriangle);
  set(EventKind::kRaySetup, Tester::kSetup);
  set(EventKind::kQuantizeRay, Tester::kQuantizer);
  set(EventKind::kAnchorTest, Tester::kAnchor);
  set(EventKind::kUpdate, Tester::kUpdate);
  set(EventKind::kDequantize, Tester::kDequantize);
  set(EventKind::kTransform, Tester::kTransform);
  return testers;
}();

class Compiler {
 public:
  Compiler(const std::vector<Event>& events, ContextPolicy context, LaneOpCounts& counts,
           LaneOps& out)
      : at_(events.data()),
        end_(events.data() + events.size()),
        context_(context),
        counts_(counts),
        out_(out) {}

  void run() {
    while (at_ != end_) {
      const Event& event = *at_++;
      const Tester tester = kTesterOf[static_cast<std::size_t>(event.kind)];
      if (tester != Tester::kCount) {
        count(event);
        test(event, tester);
      } else {
        other(event);
      }
    }
    out_.push_back(LaneOp::counted(LaneOp::Code::kEnd, 0));
  }

 private:
  void count(const Event& event) { ++counts_.events[static_cast<std::size_t>(event.kind)]; }

  void test(const Event& event, Tester tester) {
    // FP32 and quantized boxes of one node do not depend on each other: both start at once.
    if (event.kind == EventKind::kBoxTest && at_ != end_ && at_->kind == EventKind::kQBoxTest &&
        event.count > 0 && at_->count > 0) {
      count(*at_);
      out_.push_back(LaneOp::test_pair(event.count, at_++->count));
    } else if (event.count > 0) {
      out_.push_back(LaneOp::test(tester, event.count));
    }
  }

  void other(const Event& event) {
    using Code = LaneOp::Code;
    if (event.kind == EventKind::kContextPop && event.count == 0) {
      out_.push_back(LaneOp::counted(Code::kForgetContext, 0));
      return;
    }
    count(event);
    switch (event.kind) {
      case EventKind::kFetch:
        event.traffic == Traffic::kResult ? store(event) : read(event);
        return;
      case EventKind::kEscape:
        return;  // the unit emits the dequantizations and FP32 tests that it causes
      case EventKind::kPush:
        out_.push_back(LaneOp::counted(Code::kPush, event.count));
        return;
      case EventKind::kPop:
        out_.push_back(LaneOp::counted(Code::kPop, event.count));
        return;
      case EventKind::kContextPush:
        out_.push_back(LaneOp::counted(Code::kPushContext, 0));
        return;
      case EventKind::kContextPop:
        pop_context(event);
        return;
      case EventKind::kAnyHit:
        out_.push_back(LaneOp::counted(Code::kAnyHit, event.count));
        return;
      case EventKind::kIntersection:
        out_.push_back(LaneOp::counted(Code::kIntersection, event.count));
        return;
      default:
        A2RT_CHECK(false, "a ray emitted an event of unknown kind");
    }
  }

  void pop_context(const Event& event) {
    if (context_ != ContextPolicy::kRefetch) {
      out_.push_back(LaneOp::counted(LaneOp::Code::kPopContext, 0));
      return;
    }
    const bool anchor = event.traffic == Traffic::kAnchor;
    out_.push_back(LaneOp::counted(LaneOp::Code::kRefetchContext, anchor ? 1 : 2));
    read(event);
    out_.push_back(LaneOp::test(anchor ? Tester::kAnchor : Tester::kBox, 1));
    if (!anchor) {
      out_.push_back(LaneOp::test(Tester::kQuantizer, 1));
    }
  }

  void store(const Event& event) {
    const std::uint64_t last = (event.address + event.bytes - 1) / kSectorBytes;
    for (std::uint64_t s = event.address / kSectorBytes; s <= last; ++s) {
      out_.push_back(LaneOp::store(
          s / kSectorsPerLine, static_cast<SectorMask>(1u << s % kSectorsPerLine), event.traffic));
    }
  }

  // A contiguous range of records of several kinds is one read of the unit.
  void read(const Event& event) {
    record(event);
    std::uint64_t end = event.address + event.bytes;
    while (at_ != end_ && at_->kind == EventKind::kFetch && at_->address == end &&
           at_->traffic != Traffic::kResult) {
      count(*at_);
      record(*at_);
      end += at_++->bytes;
    }
    out_.back() = out_.back().as_last();
  }

  void record(const Event& event) {
    A2RT_CHECK(event.bytes > 0, "a ray fetches 0 bytes");
    ++counts_.fetches[static_cast<std::size_t>(event.traffic)];
    counts_.fetch_bytes[static_cast<std::size_t>(event.traffic)] += event.bytes;
    for_each_line(Address{event.address}, event.bytes, [&](std::uint64_t line, SectorMask sectors) {
      out_.push_back(LaneOp::read(line, sectors, event.traffic));
    });
  }

  const Event* at_;
  const Event* end_;
  ContextPolicy context_;
  LaneOpCounts& counts_;
  LaneOps& out_;
};

}  // namespace

void LaneOps::grow() {
  capacity_ = std::max<std::size_t>(256, capacity_ * 2);
  auto bigger = std::make_unique_for_overwrite<LaneOp[]>(capacity_);
  std::copy_n(data_.get(), size_, bigger.get());
  data_ = std::move(bigger);
}

void compile_lane(const std::vector<Event>& events, ContextPolicy context, LaneOpCounts& counts,
                  LaneOps& out) {
  Compiler(events, context, counts, out).run();
}

}  // namespace a2rt::timing
