// The function through which an instrumented entry point is entered: it sets the context, writes
// the records of entry and exit, and calls the program's own function in between.
#pragma once

#include "spirv/entry_inputs.h"
#include "spirv/function_pass.h"

namespace a2rt::spirv {

struct EntryWrapper {
  Id function = 0;
  std::vector<Instruction> code;
  std::vector<Id> inputs;  // variables to add to the entry point's interface
};

// For an entry point that is not instrumented but shares a function that records: nothing of it is
// recorded.
EntryWrapper wrap_silent_entry(const EntryDeclaration& entry, const Instrumentation& shared,
                               TypePool& types);

EntryWrapper wrap_entry(const EntryDeclaration& entry, const Instrumentation& shared,
                        BuiltinPool& builtins, std::uint32_t shader);

}  // namespace a2rt::spirv
