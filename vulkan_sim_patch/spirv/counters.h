// The eight counters of a running shader: two Private vectors, raised at the end of each block.
#pragma once

#include "spirv/record_writer.h"
#include "spirv/weights.h"

namespace a2rt::spirv {

class Counters {
 public:
  // With `enabled` false nothing is counted and records carry zeros.
  Counters(TypePool& types, bool enabled);

  bool enabled() const { return enabled_; }
  std::vector<Id> variables() const;
  void clear(CodeBuilder& code) const;
  // Raises the counters by `pending` and clears it.
  void flush(CodeBuilder& code, Weights& pending) const;
  // Writes the counters to units `first` and `first` + 1 of a record and clears them.
  void put(CodeBuilder& code, const RecordWriter& writer, const RecordPlace& place,
           std::uint32_t first) const;

 private:
  static constexpr std::uint32_t kHalves = capture::kCounters / 4;
  bool enabled_;
  std::array<Id, kHalves> halves_{};
};

}  // namespace a2rt::spirv
