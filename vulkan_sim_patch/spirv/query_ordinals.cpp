#include "spirv/query_ordinals.h"

#include <algorithm>

namespace a2rt::spirv {
namespace {

using spv::Op;

}  // namespace

QueryPath query_path(const Module& module, Id query, const Instruction& user) {
  const auto is_object = [&](Id id) {
    const Instruction* const defined = module.definition(id);
    return defined != nullptr &&
           (defined->op() == Op::OpVariable || defined->op() == Op::OpFunctionParameter);
  };
  if (is_object(query)) {
    return {query, 0, {}};
  }
  const Instruction* const defined = module.definition(query);
  const bool is_chain = defined != nullptr && (defined->op() == Op::OpAccessChain ||
                                               defined->op() == Op::OpInBoundsAccessChain);
  if (!is_chain || !is_object(defined->operand(0))) {
    user.fail("uses a ray query that is neither a variable nor an element of one");
  }
  const auto indices = defined->operands().subspan(1);
  return {defined->operand(0), defined->type(), {indices.begin(), indices.end()}};
}

QueryOrdinals::QueryOrdinals(TypePool& types) : types_(types) {
  // Types stand after those they consist of, so one pass finds all that hold a query.
  for (const Instruction& type : types.module().globals()) {
    if (type.op() == Op::OpTypeRayQueryKHR) {
      word_types_[type.result()] = types.uint_type();
    } else if (type.op() == Op::OpTypeArray && holds_query(type.operand(0))) {
      word_types_[type.result()] =
          types.new_aggregate(type.op(), {word_type(type.operand(0)), type.operand(1)});
    } else if (type.op() == Op::OpTypeStruct &&
               std::ranges::any_of(type.operands(), [&](Id m) { return holds_query(m); })) {
      std::vector<std::uint32_t> members;
      for (const Id member : type.operands()) {
        members.push_back(word_type(member));
      }
      word_types_[type.result()] = types.new_aggregate(type.op(), members);
    }
  }
}

Id QueryOrdinals::pointee(Id pointer_type) const {
  const Instruction* const declared = types_.module().definition(pointer_type);
  return declared != nullptr && declared->op() == Op::OpTypePointer ? declared->operand(1) : 0;
}

Id QueryOrdinals::word_type(Id type) {
  const auto known = word_types_.find(type);
  return known != word_types_.end() ? known->second : types_.uint_type();
}

Id QueryOrdinals::words_of(Id base) {
  const auto [known, fresh] = words_.emplace(base, 0);
  if (fresh) {
    const Id type = word_type(pointee(types_.module().type_of(base)));
    known->second = types_.variable(spv::StorageClass::Private, type);
    variables_.push_back(known->second);
  }
  return known->second;
}

Id QueryOrdinals::value_type(const QueryPath& path) {
  const Id pointer =
      path.element_pointer != 0 ? path.element_pointer : types_.module().type_of(path.base);
  return word_type(pointee(pointer));
}

Id QueryOrdinals::place(CodeBuilder& code, const QueryPath& path) {
  const Id words = words_of(path.base);
  if (path.indices.empty()) {
    return words;
  }
  std::vector<Id> chain{words};
  chain.insert(chain.end(), path.indices.begin(), path.indices.end());
  return code.emit(Op::OpAccessChain,
                   types_.pointer_type(spv::StorageClass::Private, value_type(path)), chain);
}

Id QueryOrdinals::load(CodeBuilder& code, const QueryPath& path) {
  return code.load(value_type(path), place(code, path));
}

void QueryOrdinals::store(CodeBuilder& code, const QueryPath& path, Id value) {
  code.store(place(code, path), value);
}

std::vector<QueryOrdinals::Passed> QueryOrdinals::passed(const Instruction& call) const {
  const Module& module = types_.module();
  const Function* const callee = module.function(call.operand(0));
  std::vector<Passed> list;
  std::vector<const Instruction*> parameters;
  for (std::size_t i = 0; callee != nullptr && i < callee->code.size(); ++i) {
    if (callee->code[i].op() == Op::OpFunctionParameter) {
      parameters.push_back(&callee->code[i]);
    }
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!holds_query(pointee(parameters[i]->type()))) {
      continue;
    }
    QueryPath path = query_path(module, call.operand(i + 1), call);
    if (std::ranges::any_of(list, [&](const Passed& one) {
          return one.argument.base == path.base && one.argument.indices == path.indices;
        })) {
      call.fail("passes one ray query twice");
    }
    list.push_back({std::move(path), parameters[i]->result()});
  }
  return list;
}

void QueryOrdinals::hand_over(CodeBuilder& code, const Instruction& call) {
  for (const Passed& one : passed(call)) {
    code.store(words_of(one.parameter), load(code, one.argument));
  }
}

void QueryOrdinals::take_back(CodeBuilder& code, const Instruction& call) {
  for (const Passed& one : passed(call)) {
    store(code, one.argument, load(code, {one.parameter, 0, {}}));
  }
}

}  // namespace a2rt::spirv
