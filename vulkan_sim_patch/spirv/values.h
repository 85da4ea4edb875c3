// Values that can be told from the module alone: constant ray flags, and where an acceleration
// structure comes from. Follows copies, function parameters and variables stored once.
#pragma once

#include <optional>
#include <span>
#include <unordered_map>

#include "spirv/call_graph.h"
#include "spirv/instrument.h"

namespace a2rt::spirv {

class ValueTracer {
 public:
  // Without `specializations` spec constants are unknown; with them, also an empty list, the
  // constants not named keep their defaults.
  ValueTracer(const Module& module, const CallGraph& calls,
              std::optional<std::span<const Specialization>> specializations);

  std::optional<std::uint32_t> constant(Id value) const;
  StructureSource structure(Id value) const;

 private:
  // A damaged module may define values in circles or in exponentially many ways.
  static constexpr int kSteps = 256;
  struct Uses {
    std::vector<Id> stored;  // values stored through the pointer
    bool other = false;      // any use but loads and stores
  };
  using Step = std::optional<std::uint32_t>;

  Step evaluate(Id value, int& steps) const;
  // `op` on the operands of `instruction` from `first` on.
  Step evaluate_operation(const Instruction& instruction, spv::Op op, std::size_t first,
                          int& steps) const;
  Step evaluate_extract(const Instruction& instruction, std::size_t first, int& steps) const;
  bool is_word(Id type) const;
  Step specialized(const Instruction& constant) const;
  Step evaluate_load(Id pointer, int& steps) const;
  // The same value for every member of `list`, else nothing.
  template <class List, class Evaluate>
  Step agreed(const List& list, Evaluate evaluate_one) const;
  // The one value stored to a variable of a function; 0 if there may be several.
  Id only_stored(Id variable) const;
  bool is_parameter(Id id) const { return parameters_.contains(id); }
  // What each call passes for the parameter.
  std::vector<Id> arguments(Id parameter) const;
  void source_of_parameter(Id parameter, StructureSource& found, int& steps) const;
  void source(Id value, StructureSource& found, int& steps) const;
  void note_uses(const Function& function);

  const Module& module_;
  const CallGraph& calls_;
  bool specialize_;
  std::unordered_map<std::uint32_t, std::uint32_t> specializations_;
  std::unordered_map<Id, Uses> uses_;                              // of pointers in functions
  std::unordered_map<Id, std::pair<Id, std::size_t>> parameters_;  // -> function, position
  std::unordered_map<Id, std::uint32_t> spec_ids_, sets_, bindings_;
};

}  // namespace a2rt::spirv
