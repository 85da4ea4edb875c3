// A ray's events as the RT unit replays them: eight bytes an operation, addresses already cut into
// sectors of lines. Rays are compiled when their warp enters the unit, in one pass over events that
// are still in the host's caches.
//
// Short stack and contexts do not depend on time: how full they are, and so which entries go to
// memory and come back, follows from a ray's own pushes and pops. What is kept on chip therefore
// leaves no operation behind; what is not becomes stores and reads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/rt/event.h"
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

  LaneOp() = default;  // of no meaning
  static LaneOp test(Tester tester, std::uint64_t count) {
    return LaneOp(Code::kTest, count << 16 | static_cast<std::uint64_t>(tester) << 8);
  }
  static LaneOp test_pair(std::uint64_t boxes, std::uint64_t quantized) {
    return LaneOp(Code::kTestPair, boxes << 16 | quantized << 32);
  }
  static LaneOp counted(Code code, std::uint64_t count) { return LaneOp(code, count << 16); }
  // Throws InternalError if the line lies beyond what eight bytes can name (2^54 B).
  static LaneOp read(std::uint64_t line, SectorMask sectors, Traffic kind) {
    return of_line(Code::kRead, line, sectors, kind);
  }
  static LaneOp store(std::uint64_t line, SectorMask sector, Traffic kind) {
    return of_line(Code::kStore, line, sector, kind);
  }
  // The last line of its read.
  LaneOp as_last() const { return LaneOp(code(), bits_ | kLast); }
  // With more sectors of the same line.
  LaneOp with(SectorMask sectors) const {
    return LaneOp(code(), bits_ | static_cast<std::uint64_t>(sectors) << 8);
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
    A2RT_CHECK(line >> (64 - kLineShift) == 0, "a ray's address is beyond 2^54");
    return LaneOp(code, line << kLineShift | static_cast<std::uint64_t>(kind) << 12 |
                            static_cast<std::uint64_t>(sectors) << 8);
  }
  LaneOp(Code code, std::uint64_t rest) : bits_(static_cast<std::uint64_t>(code) | rest) {}
  std::uint64_t bits_;
};
static_assert(sizeof(LaneOp) == 8);
static_assert(static_cast<std::size_t>(Traffic::kCount) <= 16);

// Grows like a vector, but does not clear what is about to be written.
class LaneOps {
 public:
  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }
  const LaneOp* data() const { return data_.get(); }
  const LaneOp& operator[](std::size_t i) const { return data_[i]; }
  LaneOp& back() { return data_[size_ - 1]; }
  void push_back(LaneOp op) {
    if (size_ == capacity_) [[unlikely]] {
      grow();
    }
    data_[size_++] = op;
  }

 private:
  void grow();
  std::unique_ptr<LaneOp[]> data_;
  std::size_t size_ = 0, capacity_ = 0;
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
};

// Bytes of thread-private memory for what a lane spills.
inline constexpr std::uint64_t kSpillBytesPerLane = 4096;

class LaneCompiler {
 public:
  explicit LaneCompiler(const RtConfig& config) : config_(config) {}

  // Appends the operations of one ray, kEnd last. Records that touch are one read of the unit.
  // `spill`: where the lane's spill memory begins.
  void compile(const std::vector<Event>& events, Address spill, LaneOps& out);

  const LaneOpCounts& counts() const { return counts_; }

 private:
  RtConfig config_;
  LaneOpCounts counts_;
};

}  // namespace a2rt::timing
