// kQueryStep and kQueryVerdict records of ray queries.
#pragma once

#include <map>
#include <vector>

#include "a2rt/capture/records.h"
#include "spirv/query_ordinals.h"
#include "spirv/record_writer.h"

namespace a2rt::spirv {

// Asking for a committed intersection that does not exist is undefined, and lavapipe follows a null
// pointer then. So inserted code must branch here; it does so in a function of its own, and the
// program's blocks stay whole.
class QueryRecords {
 public:
  QueryRecords(TypePool& types, const RecordWriter& writer)
      : types_(types), writer_(writer), ordinals_(types) {}

  // At OpRayQueryInitializeKHR: the query holds from now on the ray that is number `count` (from 1)
  // of its launch id; 0 if that ray is not recorded.
  void begin(CodeBuilder& code, const Instruction& initialize, Id count);
  // After OpRayQueryProceedKHR: what is committed so far.
  void put_step(CodeBuilder& code, const Instruction& proceed);
  // Before Confirm, Generate or Terminate: the candidate and what the shader decides about it.
  void put_verdict(CodeBuilder& code, const Instruction& instruction);

  // What begin() noted, kept through calls and to be listed by entry points.
  QueryOrdinals& ordinals() { return ordinals_; }

  // The functions that put_step() calls.
  std::vector<std::vector<Instruction>> take_functions();

 private:
  using Key = std::vector<Id>;

  bool is_constant(Id id) const;
  Id step_function(const QueryPath& path);
  // Values of one step.
  struct Step {
    Id query = 0;    // pointer
    Id ordinal = 0;  // as begin() noted it
    Id more = 0;     // bool: Proceed returned true
  };
  void write_step(CodeBuilder& code, const Step& step, Id entry_label) const;

  TypePool& types_;
  const RecordWriter& writer_;
  QueryOrdinals ordinals_;
  std::map<Key, Id> functions_;
  std::vector<std::vector<Instruction>> code_;
};

}  // namespace a2rt::spirv
