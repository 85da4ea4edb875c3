// Which ray a query object holds, kept beside it: several queries may be alive at once, and their
// records must not be taken for each other's.
#pragma once

#include <map>
#include <vector>

#include "spirv/code.h"

namespace a2rt::spirv {

// A query as an argument: a variable or parameter, and the way from there to an array element.
// Pointers into a variable may not be passed themselves.
struct QueryPath {
  Id base = 0;
  Id element_pointer = 0;   // type of the pointer to the query; 0 if `base` is that pointer
  std::vector<Id> indices;  // constants stay constants, others become arguments
};
// Throws SpirvError in the name of `user` if `query` is not such a pointer.
QueryPath query_path(const Module& module, Id query, const Instruction& user);

// Every query variable gets a Private variable of the same shape with a word for each query: the
// ordinal of its ray, plus one. A parameter has one too; callers copy theirs there and back, so no
// function's type changes.
class QueryOrdinals {
 public:
  explicit QueryOrdinals(TypePool& types);

  Id load(CodeBuilder& code, const QueryPath& path);
  void store(CodeBuilder& code, const QueryPath& path, Id value);
  // Around an OpFunctionCall.
  void hand_over(CodeBuilder& code, const Instruction& call);
  void take_back(CodeBuilder& code, const Instruction& call);

  const std::vector<Id>& variables() const { return variables_; }

 private:
  struct Passed {
    QueryPath argument;
    Id parameter = 0;
  };
  bool holds_query(Id type) const { return word_types_.contains(type); }
  Id pointee(Id pointer_type) const;
  Id word_type(Id type);
  Id words_of(Id base);
  Id place(CodeBuilder& code, const QueryPath& path);
  Id value_type(const QueryPath& path);
  std::vector<Passed> passed(const Instruction& call) const;

  TypePool& types_;
  std::map<Id, Id> word_types_;  // type with queries -> the same shape of words
  std::map<Id, Id> words_;       // variable or parameter -> its Private variable
  std::vector<Id> variables_;
};

}  // namespace a2rt::spirv
