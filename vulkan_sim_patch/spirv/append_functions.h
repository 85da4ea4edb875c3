// The functions of a rewritten module that append one record to the record buffer, one for each
// number of units.
//
// lavapipe runs eight invocations at once and turns every store to memory into one compare, one
// branch and one store for each of them. A record of six units written by straight-line code was
// 384 small blocks, and LLVM's register allocator spent more time on them than on the program. So
// the units of a record are stored by one loop that the driver is told not to unroll. The loop
// stands in a function of its own, hence no block of the program is split.
#pragma once

#include <map>
#include <vector>

#include "spirv/code.h"

namespace a2rt::spirv {

class RecordWriter;

class AppendFunctions {
 public:
  explicit AppendFunctions(TypePool& types) : types_(types) {}

  // uint append(uint kind, uint ordinal, uvec4 unit 1, ...): the place of the record in units.
  Id of(const RecordWriter& writer, std::uint32_t units);
  // The functions asked for.
  std::vector<std::vector<Instruction>> take();

 private:
  TypePool& types_;
  std::map<std::uint32_t, Id> ids_;
  std::vector<std::vector<Instruction>> code_;
};

}  // namespace a2rt::spirv
