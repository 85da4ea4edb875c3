// kQueryStep and kQueryVerdict records of ray queries.
#pragma once

#include <map>
#include <vector>

#include "a2rt/capture/records.h"
#include "spirv/record_writer.h"

namespace a2rt::spirv {

// Asking for a committed intersection that does not exist is undefined, and lavapipe follows a null
// pointer then. So inserted code must branch here; it does so in a function of its own, and the
// program's blocks stay whole.
class QueryRecords {
 public:
  QueryRecords(TypePool& types, const RecordWriter& writer) : types_(types), writer_(writer) {}

  // After OpRayQueryProceedKHR: what is committed so far.
  void put_step(CodeBuilder& code, const Instruction& proceed);
  // Before Confirm, Generate or Terminate: the candidate and what the shader decides about it.
  void put_verdict(CodeBuilder& code, const Instruction& instruction) const;

  // The functions that put_step() calls.
  std::vector<std::vector<Instruction>> take_functions();

 private:
  // A query as an argument: a variable or parameter, and the way from there to an array element.
  // Pointers into a variable may not be passed themselves.
  struct Path {
    Id base = 0;
    Id element_pointer = 0;   // type of the pointer to the query; 0 if `base` is that pointer
    std::vector<Id> indices;  // constants stay constants, others become arguments
  };
  using Key = std::vector<Id>;

  Path path_to(const Instruction& proceed) const;
  bool is_constant(Id id) const;
  Id step_function(const Path& path);
  void write_step(CodeBuilder& code, Id query, Id more, Id entry_label) const;

  TypePool& types_;
  const RecordWriter& writer_;
  std::map<Key, Id> functions_;
  std::vector<std::vector<Instruction>> code_;
};

}  // namespace a2rt::spirv
