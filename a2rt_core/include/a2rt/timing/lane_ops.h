// A ray's events as the RT unit replays them: eight bytes an operation, addresses already cut into
// sectors of lines. Rays are traversed, and their events compiled as they come, when their warp
// enters the unit.
//
// Short stack and contexts do not depend on time: how full they are, and so which entries go to
// memory and come back, follows from a ray's own pushes and pops. What is kept on chip therefore
// leaves no operation behind; what is not becomes stores and reads.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "a2rt/base/error.h"
#include "a2rt/rt/event_receiver.h"
#include "a2rt/timing/machine_config.h"
#include "a2rt/timing/memory_port.h"

namespace a2rt::timing {

class LaneOp {
 public:
  enum class Code : std::uint8_t {
    kTest,      // `count` tests on a tester
    kTestPair,  // `count` box and `second` quantized box tests, which do not depend on each other
    kRead,      // one line of a read; the lane waits after the last one
    kStore,
    kAnyHit,
    kIntersection,
    kEnd
  };

  static constexpr std::uint32_t kMostTests = 0xffff;  // in one operation

  LaneOp() = default;  // of no meaning
  static LaneOp test(Tester tester, std::uint64_t count) {
    return LaneOp(Code::kTest, count << 16 | static_cast<std::uint64_t>(tester) << 8);
  }
  static LaneOp test_pair(std::uint64_t boxes, std::uint64_t quantized) {
    return LaneOp(Code::kTestPair, boxes << 16 | quantized << 32);
  }
  static LaneOp counted(Code code, std::uint64_t count) { return LaneOp(code, count << 16); }
  // What eight bytes can name (2^54 B); others throw InternalError.
  static constexpr std::uint64_t kMostLine = (std::uint64_t{1} << 47) - 1;
  static LaneOp read(std::uint64_t line, SectorMask sectors, Traffic kind) {
    return of_line(Code::kRead, line, sectors, kind);
  }
  static LaneOp store(std::uint64_t line, SectorMask sector, Traffic kind) {
    return of_line(Code::kStore, line, sector, kind);
  }
  // The last line of its read, or not.
  LaneOp as_last(bool last = true) const {
    return LaneOp(code(), (bits_ & ~kLast) | (last ? kLast : 0));
  }
  // A read of this line and the next: from the fifth on, bits stand for the next one's sectors; if
  // there are none, the first is the last. Both are known to be in range.
  static std::pair<LaneOp, LaneOp> reads(std::uint64_t line, std::uint64_t sectors, Traffic kind) {
    const LaneOp none(Code::kRead, rest_of(line, 0, kind));
    LaneOp first = none, second = none;
    first.bits_ += ((sectors & 0xf) << 8) + (sectors > 0xf ? 0 : kLast);
    second.bits_ += (std::uint64_t{1} << kLineShift) + (sectors >> kSectorsPerLine << 8) + kLast;
    return {first, second};
  }
  // With more sectors of the same line.
  LaneOp with(SectorMask sectors) const {
    return LaneOp(code(), bits_ | static_cast<std::uint64_t>(sectors) << 8);
  }

  // Spilled entries, in a ray's own memory.
  bool names_spill_memory() const {
    return (code() == Code::kRead || code() == Code::kStore) && kind() == Traffic::kStack;
  }
  // With the address as far from `to` as it is from `from`; both are at the start of a line.
  LaneOp moved(Address from, Address to) const {
    return LaneOp(code(), bits_ + ((to.value - from.value) / kLineBytes << kLineShift));
  }

  Code code() const { return static_cast<Code>(bits_ & 0xff); }
  // Tests are worked out ahead of time; the rest has its cycle.
  bool is_test() const { return code() <= Code::kTestPair; }
  std::uint32_t count() const { return bits_ >> 16 & 0xffff; }
  std::uint32_t second() const { return bits_ >> 32 & 0xffff; }
  Tester tester() const { return static_cast<Tester>(bits_ >> 8 & 0xff); }
  std::uint64_t line() const { return bits_ >> kLineShift; }
  SectorMask sectors() const { return bits_ >> 8 & 0xf; }
  Traffic kind() const { return static_cast<Traffic>(bits_ >> 12 & 0xf); }
  bool last() const { return (bits_ & kLast) != 0; }

 private:
  static constexpr std::uint32_t kLineShift = 17;
  static constexpr std::uint64_t kLast = std::uint64_t{1} << 16;
  static LaneOp of_line(Code code, std::uint64_t line, SectorMask sectors, Traffic kind) {
    A2RT_CHECK(line <= kMostLine, "a ray's address is beyond 2^54");
    return LaneOp(code, rest_of(line, sectors, kind));
  }
  static std::uint64_t rest_of(std::uint64_t line, std::uint64_t sectors, Traffic kind) {
    return line << kLineShift | static_cast<std::uint64_t>(kind) << 12 | sectors << 8;
  }
  LaneOp(Code code, std::uint64_t rest) : bits_(static_cast<std::uint64_t>(code) | rest) {}
  std::uint64_t bits_;
};
static_assert(sizeof(LaneOp) == 8);
static_assert(static_cast<std::size_t>(Traffic::kCount) <= 16);

// Grows like a vector, but does not clear what is about to be written.
class LaneOps {
 public:
  LaneOps() = default;
  LaneOps(LaneOps&& other) noexcept
      : data_(std::move(other.data_)),
        end_(std::exchange(other.end_, nullptr)),
        limit_(std::exchange(other.limit_, nullptr)) {}
  void clear() { end_ = data_.get(); }
  std::size_t size() const { return static_cast<std::size_t>(end_ - data_.get()); }
  const LaneOp* data() const { return data_.get(); }
  const LaneOp& operator[](std::size_t i) const { return data_[i]; }
  LaneOp& back() { return end_[-1]; }
  LaneOp pop_back() { return *--end_; }
  void push_back(LaneOp op) {
    if (!has_room()) [[unlikely]] {
      return push_grown(op);  // a call at the very end, for which callers need not save anything
    }
    *end_++ = op;
  }
  // For one or two.
  bool has_room() const { return end_ < limit_; }
  // The second only if `both`; there is room.
  void push_back(const std::pair<LaneOp, LaneOp>& ops, bool both) {
    end_[0] = ops.first;
    end_[1] = ops.second;
    end_ += both ? 2 : 1;
  }

 private:
  void push_grown(LaneOp op);
  std::unique_ptr<LaneOp[]> data_;
  LaneOp* end_ = nullptr;
  LaneOp* limit_ = nullptr;  // one before the end of the memory
};

// What compiling counts; it does not depend on when the operations are carried out.
struct LaneOpCounts {
  std::array<std::uint64_t, static_cast<std::size_t>(EventKind::kCount)> events{};
  TrafficCounts fetches{}, fetch_bytes{};
  TrafficCounts sectors_wanted{};                     // a lane's, before merging with others'
  std::uint64_t stack_spills = 0, stack_fills = 0;    // sectors
  std::uint64_t stack_pushed = 0, stack_popped = 0;   // entries through the on-chip stack
  std::uint64_t stack_spilled = 0, stack_filled = 0;  // entries
  std::uint64_t context_saves = 0, context_restores = 0;
  std::uint64_t context_spills = 0, context_fills = 0;  // contexts
  std::uint64_t context_refetches = 0, context_refetch_steps = 0;

  // All of them in a row.
  static constexpr std::size_t kNumbers =
      static_cast<std::size_t>(EventKind::kCount) + 3 * kTrafficKinds + 12;
  using Numbers = std::array<std::uint64_t, kNumbers>;
  static Numbers as_numbers(const LaneOpCounts& counts) { return std::bit_cast<Numbers>(counts); }
  static LaneOpCounts of_numbers(const Numbers& numbers) {
    return std::bit_cast<LaneOpCounts>(numbers);
  }
};

// One of the numbers of LaneOpCounts.
class LaneOpCount {
 public:
  static constexpr std::uint64_t kMost = (std::uint64_t{1} << 25) - 1;
  LaneOpCount() = default;
  // `value` is at most kMost.
  LaneOpCount(std::uint32_t index, std::uint64_t value)
      : bits_(static_cast<std::uint32_t>(value) << kIndexBits | index) {}
  std::uint32_t index() const { return bits_ & ((1u << kIndexBits) - 1); }
  std::uint32_t value() const { return bits_ >> kIndexBits; }

 private:
  static constexpr std::uint32_t kIndexBits = 7;
  static_assert(LaneOpCounts::kNumbers <= 1u << kIndexBits);
  std::uint32_t bits_;
};

// Bytes of thread-private memory for what a lane spills.
inline constexpr std::uint64_t kSpillBytesPerLane = 4096;

// Makes operations of the events between begin() and end(), which are one ray's.
class LaneCompiler final : public EventReceiver {
 public:
  explicit LaneCompiler(const RtConfig& config);

  // `spill`: where the lane's spill memory begins. Operations are appended to `out`, kEnd last.
  void begin(Address spill, LaneOps& out);
  void end() { out_->push_back(LaneOp::counted(LaneOp::Code::kEnd, 0)); }
  // Counts a ray again whose operations are known.
  void count_again(std::span<const LaneOpCount> counts);

  // Records that touch, with no other event between them, are one read of the unit.
  void fetch(Traffic traffic, Address address, std::uint32_t bytes) override;
  void test(EventKind kind, std::uint32_t count) override;
  void push(std::uint32_t count) override;
  void pop(std::uint32_t count) override;
  void context_push() override;
  void context_pop(Traffic traffic, Address address, std::uint32_t bytes) override;
  void context_forget() override;
  void leave_unit(EventKind kind, std::uint32_t count) override;
  void escape(std::uint32_t count) override;

  // Of the rays compiled, and of those counted again.
  LaneOpCounts counts() const;

 private:
  // What the event just seen leaves open.
  enum class Open : std::uint8_t {
    kNothing,
    kBoxTest,    // quantized boxes of the same node may start with its FP32 boxes
    kRead,       // the next record may belong to the read
    kRefetched,  // likewise, and `repeated_` tests wait for all of it
  };

  A2RT_INLINE void count(EventKind kind) { ++counts_.events[static_cast<std::size_t>(kind)]; }
  void read(Traffic kind, Address address, std::uint64_t bytes);
  A2RT_NOINLINE void read_any(Traffic kind, Address address, std::uint64_t bytes);
  void store(Address address, std::uint64_t bytes, Traffic kind);
  void fill(Address address, std::uint64_t bytes);
  A2RT_NOINLINE void spill_stack();
  A2RT_NOINLINE void fill_stack(std::uint32_t count);
  void pop_saved_context();
  void refetch_context(Traffic traffic, Address address, std::uint32_t bytes);
  std::uint32_t entries_per_sector() const;
  Address stack_address() const;
  Address context_address() const;

  Open open_ = Open::kNothing;
  std::uint8_t repeated_ = 0;
  std::uint32_t stack_ = 0, spilled_ = 0;
  std::uint32_t contexts_ = 0, contexts_spilled_ = 0;
  std::uint32_t most_stack_;
  Address read_end_;
  LaneOps* out_ = nullptr;
  LaneOpCounts counts_;
  LaneOpCounts::Numbers counts_again_{};
  Address spill_;
  RtConfig config_;
};

}  // namespace a2rt::timing
