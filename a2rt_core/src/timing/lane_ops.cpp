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

// Each lane's spill memory holds stack entries in its lower half, contexts in its upper.
constexpr std::uint64_t kSpillArea = kSpillBytesPerLane / 2;

// One ray on its way from events to operations.
class RayCompiler {
 public:
  RayCompiler(const std::vector<Event>& events, const RtConfig& config, Address spill,
              LaneOpCounts& counts, LaneOps& out)
      : at_(events.data()),
        end_(events.data() + events.size()),
        config_(config),
        spill_(spill),
        counts_(counts),
        out_(out) {}

  void run() {
    while (at_ != end_) {
      const Event& event = *at_++;
      count(event);
      const Tester tester = kTesterOf[static_cast<std::size_t>(event.kind)];
      if (tester != Tester::kCount) {
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
    switch (event.kind) {
      case EventKind::kFetch:
        event.traffic == Traffic::kResult
            ? store(Address{event.address}, event.bytes, event.traffic)
            : read(event);
        return;
      case EventKind::kEscape:
        return;  // the unit emits the dequantizations and FP32 tests that it causes
      case EventKind::kPush:
        push(event.count);
        return;
      case EventKind::kPop:
        pop(event.count);
        return;
      case EventKind::kContextPush:
        push_context();
        return;
      case EventKind::kContextPop:
        event.count == 0                             ? forget_context()
        : config_.context == ContextPolicy::kRefetch ? refetch_context(event)
                                                     : pop_context();
        return;
      case EventKind::kAnyHit:
        out_.push_back(LaneOp::counted(LaneOp::Code::kAnyHit, event.count));
        return;
      case EventKind::kIntersection:
        out_.push_back(LaneOp::counted(LaneOp::Code::kIntersection, event.count));
        return;
      default:
        A2RT_CHECK(false, "a ray emitted an event of unknown kind");
    }
  }

  // Entries leave for memory a sector at a time, oldest first, so that one store moves several.
  void push(std::uint32_t count) {
    const std::uint32_t limit = config_.stack_entries;
    stack_ += count;
    counts_.stack_pushed += count;
    while (limit > 0 && stack_ > limit) [[unlikely]] {
      const std::uint32_t moved = std::min(entries_per_sector(), stack_);
      store(stack_address(), moved * config_.stack_entry_bytes, Traffic::kStack);
      stack_ -= moved;
      spilled_ += moved;
      ++counts_.stack_spills;
      counts_.stack_spilled += moved;
    }
  }

  void pop(std::uint32_t count) {
    A2RT_CHECK(count <= stack_ + spilled_, "a ray pops more than it pushed");
    counts_.stack_popped += count;
    if (stack_ >= count) [[likely]] {
      stack_ -= count;
      return;
    }
    const std::uint32_t per_sector = entries_per_sector();
    const std::uint32_t lacking = count - stack_;
    const std::uint32_t moved =
        std::min(spilled_, (lacking + per_sector - 1) / per_sector * per_sector);
    spilled_ -= moved;
    stack_ = stack_ + moved - count;
    counts_.stack_fills += (moved + per_sector - 1) / per_sector;
    counts_.stack_filled += moved;
    fill(stack_address(), moved * config_.stack_entry_bytes);
  }

  void push_context() {
    ++contexts_;
    if (config_.context == ContextPolicy::kRefetch) {
      return;
    }
    ++counts_.context_saves;
    if (config_.context_entries == 0 || contexts_ <= config_.context_entries) {
      return;
    }
    store(context_address(), config_.context_bytes, Traffic::kStack);
    --contexts_;
    ++contexts_spilled_;
    ++counts_.context_spills;
  }

  void pop_context() {
    A2RT_CHECK(contexts_ + contexts_spilled_ > 0, "a ray restores a context it never saved");
    ++counts_.context_restores;
    if (contexts_ > 0) {
      --contexts_;
      return;
    }
    --contexts_spilled_;
    ++counts_.context_fills;
    fill(context_address(), config_.context_bytes);
  }

  void forget_context() {
    A2RT_CHECK(contexts_ + contexts_spilled_ > 0, "a ray forgets a context it never saved");
    --counts_.events[static_cast<std::size_t>(EventKind::kContextPop)];  // nothing is popped
    --(contexts_ > 0 ? contexts_ : contexts_spilled_);
  }

  // Reads the record again and repeats what was made of it.
  void refetch_context(const Event& event) {
    A2RT_CHECK(contexts_ > 0, "a ray restores a context it never saved");
    --contexts_;
    const bool anchor = event.traffic == Traffic::kAnchor;
    ++counts_.context_refetches;
    counts_.context_refetch_steps += anchor ? 1 : 2;
    read(event);
    out_.push_back(LaneOp::test(anchor ? Tester::kAnchor : Tester::kBox, 1));
    if (!anchor) {
      out_.push_back(LaneOp::test(Tester::kQuantizer, 1));
    }
  }

  std::uint32_t entries_per_sector() const {
    return static_cast<std::uint32_t>(kSectorBytes) / config_.stack_entry_bytes;
  }
  Address stack_address() const {
    return spill_ + Bytes{std::uint64_t{spilled_} * config_.stack_entry_bytes % kSpillArea};
  }
  Address context_address() const {
    return spill_ + Bytes{kSpillArea +
                          std::uint64_t{contexts_spilled_} * config_.context_bytes % kSpillArea};
  }

  void store(Address address, std::uint64_t bytes, Traffic kind) {
    const std::uint64_t last = (address.value + bytes - 1) / kSectorBytes;
    for (std::uint64_t s = address.value / kSectorBytes; s <= last; ++s) {
      out_.push_back(LaneOp::store(s / kSectorsPerLine,
                                   static_cast<SectorMask>(1u << s % kSectorsPerLine), kind));
    }
  }

  // What was spilled comes back; nothing else is part of its read.
  void fill(Address address, std::uint64_t bytes) {
    begin_read();
    record(address.value, bytes, Traffic::kStack);
    out_.back() = out_.back().as_last();
  }

  // A contiguous range of records of several kinds is one read of the unit.
  void read(const Event& event) {
    begin_read();
    record(event.address, event.bytes, event.traffic);
    std::uint64_t end = event.address + event.bytes;
    while (at_ != end_ && at_->kind == EventKind::kFetch && at_->address == end &&
           at_->traffic != Traffic::kResult) {
      count(*at_);
      record(at_->address, at_->bytes, at_->traffic);
      end += at_++->bytes;
    }
    out_.back() = out_.back().as_last();
  }

  void begin_read() { line_ = ~std::uint64_t{0}; }

  A2RT_NOINLINE void record(std::uint64_t address, std::uint64_t bytes, Traffic kind) {
    A2RT_CHECK(bytes > 0, "a ray fetches 0 bytes");
    const auto k = static_cast<std::size_t>(kind);
    ++counts_.fetches[k];
    counts_.fetch_bytes[k] += bytes;
    for_each_line(Address{address}, bytes, [&](std::uint64_t line, SectorMask sectors) {
      if (line != line_) [[likely]] {
        line_ = line;
        counts_.sectors_wanted[k] += sectors_in(sectors);
        out_.push_back(LaneOp::read(line, sectors, kind));
        return;
      }
      // The record before it, in the same read, ended in this line.
      LaneOp& before = out_.back();
      counts_.sectors_wanted[k] += sectors_in(static_cast<SectorMask>(sectors & ~before.sectors()));
      before = before.with(sectors);
    });
  }

  const Event* at_;
  const Event* end_;
  const RtConfig& config_;
  Address spill_;
  std::uint64_t line_ = 0;  // last one of the present read
  std::uint32_t stack_ = 0, spilled_ = 0;
  std::uint32_t contexts_ = 0, contexts_spilled_ = 0;
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

void LaneCompiler::compile(const std::vector<Event>& events, Address spill, LaneOps& out) {
  RayCompiler(events, config_, spill, counts_, out).run();
}

}  // namespace a2rt::timing
