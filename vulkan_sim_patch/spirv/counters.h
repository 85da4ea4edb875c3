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
  static constexpr std::uint32_t kHalves = capture::kCounters / 4;
  // The counters as units of a record; they are cleared.
  std::array<Id, kHalves> take(CodeBuilder& code) const;

 private:
  bool enabled_;
  std::array<Id, kHalves> halves_{};
};

}  // namespace a2rt::spirv
