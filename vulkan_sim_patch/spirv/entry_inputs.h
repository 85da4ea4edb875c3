// Builtin inputs of one entry point. An entry point must not list two variables of one builtin, so
// what it has is used, and what is added is added to it alone.
#pragma once

#include <map>
#include <unordered_map>

#include "spirv/call_graph.h"
#include "spirv/code.h"

namespace a2rt::spirv {

// Builtin variables of the module, and those made for it.
class BuiltinPool {
 public:
  explicit BuiltinPool(TypePool& types);
  // The builtin of an input variable of the module; false if it is none.
  bool builtin_of(Id variable, spv::BuiltIn& builtin) const;
  // A variable of `type` made here, shared by all entry points that lack their own.
  Id made(spv::BuiltIn builtin, Id type);
  // The constant decorated WorkgroupSize; 0 if there is none.
  Id workgroup_size() const { return workgroup_size_; }
  TypePool& types() { return types_; }

 private:
  TypePool& types_;
  std::unordered_map<Id, spv::BuiltIn> existing_;
  std::map<spv::BuiltIn, Id> made_;
  Id workgroup_size_ = 0;
};

class EntryInputs {
 public:
  EntryInputs(BuiltinPool& pool, const EntryDeclaration& entry);
  // Loads the builtin; `type` is used if the entry point does not declare it with a type of its
  // own.
  Id load(CodeBuilder& code, spv::BuiltIn builtin, Id type);
  // Variables to add to the entry point's interface.
  const std::vector<Id>& used() const { return used_; }

 private:
  BuiltinPool& pool_;
  std::map<spv::BuiltIn, Id> variables_;
  std::vector<Id> used_;
};

}  // namespace a2rt::spirv
