#include "a2rt/timing/lane_ops.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "a2rt/base/error.h"

namespace a2rt::timing {
namespace {

// The tester that a test goes to; kCount: the event is no test.
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

}  // namespace

void LaneOps::push_grown(LaneOp op) {
  const std::size_t size = this->size(), capacity = std::max<std::size_t>(256, size * 2);
  auto bigger = std::make_unique_for_overwrite<LaneOp[]>(capacity);
  std::copy_n(data_.get(), size, bigger.get());
  data_ = std::move(bigger);
  end_ = data_.get() + size;
  limit_ = data_.get() + capacity - 1;
  *end_++ = op;
}

LaneCompiler::LaneCompiler(const RtConfig& config)
    : most_stack_(config.stack_entries == 0 ? std::numeric_limits<std::uint32_t>::max()
                                            : config.stack_entries),
      config_(config) {}

void LaneCompiler::begin(Address spill, LaneOps& out) {
  spill_ = spill;
  out_ = &out;
  open_ = Open::kNothing;
  stack_ = spilled_ = contexts_ = contexts_spilled_ = 0;
}

void LaneCompiler::count_again(std::span<const LaneOpCount> counts) {
  for (const LaneOpCount count : counts) {
    counts_again_[count.index()] += count.value();
  }
}

LaneOpCounts LaneCompiler::counts() const {
  LaneOpCounts::Numbers all = LaneOpCounts::as_numbers(counts_);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i] += counts_again_[i];
  }
  return LaneOpCounts::of_numbers(all);
}

void LaneCompiler::fetch(Traffic traffic, Address address, std::uint32_t bytes) {
  count(EventKind::kFetch);
  if (traffic == Traffic::kResult) [[unlikely]] {
    open_ = Open::kNothing;
    store(address, bytes, traffic);
  } else {
    read(traffic, address, bytes);
  }
}

void LaneCompiler::test(EventKind kind, std::uint32_t n) {
  count(kind);
  const Open open = std::exchange(open_, Open::kNothing);
  if (n == 0) [[unlikely]] {
    return;
  }
  // FP32 and quantized boxes of one node do not depend on each other: both start at once.
  if (open == Open::kBoxTest && kind == EventKind::kQBoxTest) {
    out_->back() = LaneOp::test_pair(out_->back().count(), n);
    return;
  }
  open_ = kind == EventKind::kBoxTest ? Open::kBoxTest : Open::kNothing;
  const Tester tester = kTesterOf[static_cast<std::size_t>(kind)];
  A2RT_CHECK(tester != Tester::kCount && n <= LaneOp::kMostTests, "a unit emitted no test");
  out_->push_back(LaneOp::test(tester, n));
}

void LaneCompiler::push(std::uint32_t n) {
  count(EventKind::kPush);
  open_ = Open::kNothing;
  stack_ += n;
  counts_.stack_pushed += n;
  if (stack_ > most_stack_) [[unlikely]] {
    spill_stack();
  }
}

void LaneCompiler::pop(std::uint32_t n) {
  count(EventKind::kPop);
  open_ = Open::kNothing;
  counts_.stack_popped += n;
  if (stack_ < n) [[unlikely]] {
    return fill_stack(n);
  }
  stack_ -= n;
}

void LaneCompiler::context_push() {
  count(EventKind::kContextPush);
  open_ = Open::kNothing;
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

void LaneCompiler::context_pop(Traffic traffic, Address address, std::uint32_t bytes) {
  count(EventKind::kContextPop);
  open_ = Open::kNothing;
  if (config_.context == ContextPolicy::kRefetch) {
    refetch_context(traffic, address, bytes);
  } else {
    pop_saved_context();
  }
}

void LaneCompiler::context_forget() {
  open_ = Open::kNothing;
  A2RT_CHECK(contexts_ + contexts_spilled_ > 0, "a ray forgets a context it never saved");
  --(contexts_ > 0 ? contexts_ : contexts_spilled_);
}

void LaneCompiler::leave_unit(EventKind kind, std::uint32_t n) {
  count(kind);
  open_ = Open::kNothing;
  out_->push_back(LaneOp::counted(
      kind == EventKind::kAnyHit ? LaneOp::Code::kAnyHit : LaneOp::Code::kIntersection, n));
}

// The unit emits the dequantizations and FP32 tests that it causes.
void LaneCompiler::escape(std::uint32_t) {
  count(EventKind::kEscape);
  open_ = Open::kNothing;
}

// Entries leave for memory a sector at a time, oldest first, so that one store moves several.
void LaneCompiler::spill_stack() {
  while (stack_ > most_stack_) {
    const std::uint32_t moved = std::min(entries_per_sector(), stack_);
    store(stack_address(), moved * config_.stack_entry_bytes, Traffic::kStack);
    stack_ -= moved;
    spilled_ += moved;
    ++counts_.stack_spills;
    counts_.stack_spilled += moved;
  }
}

void LaneCompiler::fill_stack(std::uint32_t wanted) {
  A2RT_CHECK(wanted <= stack_ + spilled_, "a ray pops more than it pushed");
  const std::uint32_t per_sector = entries_per_sector();
  const std::uint32_t lacking = wanted - stack_;
  const std::uint32_t moved =
      std::min(spilled_, (lacking + per_sector - 1) / per_sector * per_sector);
  spilled_ -= moved;
  stack_ = stack_ + moved - wanted;
  counts_.stack_fills += (moved + per_sector - 1) / per_sector;
  counts_.stack_filled += moved;
  fill(stack_address(), moved * config_.stack_entry_bytes);
}

void LaneCompiler::pop_saved_context() {
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

// Reads the record again and repeats what was made of it.
void LaneCompiler::refetch_context(Traffic traffic, Address address, std::uint32_t bytes) {
  A2RT_CHECK(contexts_ > 0, "a ray restores a context it never saved");
  --contexts_;
  const bool anchor = traffic == Traffic::kAnchor;
  ++counts_.context_refetches;
  counts_.context_refetch_steps += anchor ? 1 : 2;
  read(traffic, address, bytes);
  out_->push_back(LaneOp::test(anchor ? Tester::kAnchor : Tester::kBox, 1));
  if (!anchor) {
    out_->push_back(LaneOp::test(Tester::kQuantizer, 1));
  }
  open_ = Open::kRefetched;
  repeated_ = anchor ? 1 : 2;
}

std::uint32_t LaneCompiler::entries_per_sector() const {
  return static_cast<std::uint32_t>(kSectorBytes) / config_.stack_entry_bytes;
}
Address LaneCompiler::stack_address() const {
  return spill_ + Bytes{std::uint64_t{spilled_} * config_.stack_entry_bytes % kSpillArea};
}
Address LaneCompiler::context_address() const {
  return spill_ +
         Bytes{kSpillArea + std::uint64_t{contexts_spilled_} * config_.context_bytes % kSpillArea};
}

void LaneCompiler::store(Address address, std::uint64_t bytes, Traffic kind) {
  const std::uint64_t last = (address.value + bytes - 1) / kSectorBytes;
  for (std::uint64_t s = address.value / kSectorBytes; s <= last; ++s) {
    out_->push_back(LaneOp::store(s / kSectorsPerLine,
                                  static_cast<SectorMask>(1u << s % kSectorsPerLine), kind));
  }
}

// What was spilled comes back; nothing else is part of its read.
void LaneCompiler::fill(Address address, std::uint64_t bytes) {
  open_ = Open::kNothing;
  read(Traffic::kStack, address, bytes);
  open_ = Open::kNothing;
}

A2RT_INLINE void LaneCompiler::read(Traffic kind, Address address, std::uint64_t bytes) {
  const std::uint64_t first = address.value / kSectorBytes;
  const std::uint64_t last = (address.value + bytes - 1) / kSectorBytes;
  const std::uint64_t line = first / kSectorsPerLine, last_line = last / kSectorsPerLine;
  const bool joins = open_ >= Open::kRead && address == read_end_;
  if (joins || bytes == 0 || last_line - line > 1 || last_line > LaneOp::kMostLine ||
      !out_->has_room()) [[unlikely]] {
    return read_any(kind, address, bytes);
  }
  // Most records are a read of their own, of one line or two.
  const std::uint64_t sectors = ((std::uint64_t{2} << (last - first)) - 1)
                                << first % kSectorsPerLine;
  const auto k = static_cast<std::size_t>(kind);
  ++counts_.fetches[k];
  counts_.fetch_bytes[k] += bytes;
  counts_.sectors_wanted[k] += last - first + 1;
  open_ = Open::kRead;
  read_end_ = address + Bytes{bytes};
  out_->push_back(LaneOp::reads(line, sectors, kind), last_line != line);
}

// Any number of lines, which may go on with the read that is open.
void LaneCompiler::read_any(Traffic kind, Address address, std::uint64_t bytes) {
  A2RT_CHECK(bytes > 0, "a ray fetches 0 bytes");
  const auto k = static_cast<std::size_t>(kind);
  ++counts_.fetches[k];
  counts_.fetch_bytes[k] += bytes;
  std::uint64_t shared = ~std::uint64_t{0};  // the line in which the record before it ended
  std::array<LaneOp, 2> repeated;
  std::size_t waiting = 0;
  if (open_ >= Open::kRead && address == read_end_) {
    for (; open_ == Open::kRefetched && waiting < repeated_; ++waiting) {
      repeated[waiting] = out_->pop_back();
    }
    out_->back() = out_->back().as_last(false);
    shared = out_->back().line();
  } else {
    open_ = Open::kRead;
  }
  read_end_ = address + Bytes{bytes};
  for_each_line(address, bytes, [&](std::uint64_t line, SectorMask sectors) {
    if (line != shared) {
      counts_.sectors_wanted[k] += sectors_in(sectors);
      out_->push_back(LaneOp::read(line, sectors, kind));
      return;
    }
    LaneOp& before = out_->back();
    counts_.sectors_wanted[k] += sectors_in(static_cast<SectorMask>(sectors & ~before.sectors()));
    before = before.with(sectors);
  });
  out_->back() = out_->back().as_last();
  while (waiting > 0) {
    out_->push_back(repeated[--waiting]);
  }
}

}  // namespace a2rt::timing
