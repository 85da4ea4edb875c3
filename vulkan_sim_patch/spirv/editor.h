// Collects the edits of one module and writes the result: capability, memory model, entry points,
// decorations, globals, functions. The source module stays as it is.
#pragma once

#include <map>
#include <vector>

#include "spirv/call_graph.h"
#include "spirv/types.h"

namespace a2rt::spirv {

class ModuleEditor {
 public:
  // Throws SpirvError if the module has no memory model.
  ModuleEditor(const Module& module, TypePool& types);

  // Makes device addresses usable: capability, extension, PhysicalStorageBuffer64.
  void use_device_addresses();
  // `entry` enters through `function` from now on and uses `variables` besides its own.
  void redirect(const EntryDeclaration& entry, Id function, const std::vector<Id>& variables);
  void add_mode(Id function, spv::ExecutionMode mode);
  void replace_function(Id function, std::vector<Instruction> code);
  void add_function(std::vector<Instruction> code) { added_.push_back(std::move(code)); }

  std::vector<std::uint32_t> words() const;

 private:
  struct Redirection {
    Id function = 0;
    std::vector<Id> variables;
  };
  Instruction edited_entry(const Instruction& entry) const;
  void append_execution_mode(std::vector<std::uint32_t>& out, const Instruction& mode) const;
  void append_global(std::vector<std::uint32_t>& out, const Instruction& instruction) const;

  const Module& module_;
  TypePool& types_;
  bool device_addresses_ = false;
  std::vector<EntryDeclaration> entries_;
  std::map<const Instruction*, Redirection> redirections_;
  std::vector<Instruction> modes_;
  std::map<Id, std::vector<Instruction>> replaced_;
  std::vector<std::vector<Instruction>> added_;
};

}  // namespace a2rt::spirv
