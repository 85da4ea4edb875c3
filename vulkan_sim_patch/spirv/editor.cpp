#include "spirv/editor.h"

#include <algorithm>
#include <set>

#include "spirv/opcodes.h"

namespace a2rt::spirv {
namespace {

constexpr std::uint32_t kVersion15 = 0x00010500;
constexpr const char* kAddressExtension = "SPV_KHR_physical_storage_buffer";

// Instructions that can only stand before the first type, constant or variable.
bool is_preamble(const Instruction& instruction) {
  const OpcodeInfo* const info = opcode_info(static_cast<std::uint32_t>(instruction.op()));
  if (info == nullptr) {
    return false;
  }
  return info->group == OpcodeClass::kAnnotation || info->group == OpcodeClass::kModeSetting ||
         instruction.op() == spv::Op::OpName || instruction.op() == spv::Op::OpMemberName ||
         instruction.op() == spv::Op::OpModuleProcessed ||
         instruction.op() == spv::Op::OpExtInstImport || instruction.op() == spv::Op::OpExtension;
}

template <class Predicate>
std::size_t after_last(const std::vector<Instruction>& list, std::size_t otherwise,
                       Predicate matches) {
  for (std::size_t i = list.size(); i > 0; --i) {
    if (matches(list[i - 1])) {
      return i;
    }
  }
  return otherwise;
}

}  // namespace

ModuleEditor::ModuleEditor(const Module& module, TypePool& types)
    : module_(module), types_(types), entries_(entry_declarations(module)) {
  if (std::ranges::none_of(module.globals(),
                           [](const Instruction& i) { return i.op() == spv::Op::OpMemoryModel; })) {
    throw SpirvError(Module::kHeaderWords, "the module has no OpMemoryModel");
  }
}

void ModuleEditor::use_device_addresses() { device_addresses_ = true; }

void ModuleEditor::redirect(const EntryDeclaration& entry, Id function,
                            const std::vector<Id>& variables) {
  redirections_[entry.instruction] = {function, variables};
}

void ModuleEditor::add_mode(Id function, spv::ExecutionMode mode) {
  modes_.emplace_back(spv::Op::OpExecutionMode,
                      std::vector{function, static_cast<std::uint32_t>(mode)});
}

void ModuleEditor::replace_function(Id function, std::vector<Instruction> code) {
  replaced_.insert_or_assign(function, std::move(code));
}

Instruction ModuleEditor::edited_entry(const Instruction& entry) const {
  const auto found = redirections_.find(&entry);
  if (found == redirections_.end()) {
    return entry;
  }
  const Redirection& edit = found->second;
  std::vector<std::uint32_t> words(entry.words().begin() + 1, entry.words().end());
  words[1] = edit.function != 0 ? edit.function : words[1];
  std::size_t first_variable = 0;
  entry.string_operand(2, &first_variable);
  std::set<Id> listed(entry.operands().begin() + static_cast<std::ptrdiff_t>(first_variable),
                      entry.operands().end());
  for (const Id variable : edit.variables) {
    if (listed.insert(variable).second) {
      words.push_back(variable);
    }
  }
  return Instruction(spv::Op::OpEntryPoint, words, entry.offset());
}

void ModuleEditor::append_execution_mode(std::vector<std::uint32_t>& out,
                                         const Instruction& mode) const {
  // A mode belongs to a function; entry points that shared one may enter through several now.
  std::set<Id> targets;
  for (const EntryDeclaration& entry : entries_) {
    if (entry.function != mode.operand(0)) {
      continue;
    }
    const auto found = redirections_.find(entry.instruction);
    const bool moved = found != redirections_.end() && found->second.function != 0;
    targets.insert(moved ? found->second.function : entry.function);
  }
  if (targets.empty()) {
    append(out, mode);
  }
  for (const Id target : targets) {
    Instruction copy = mode;
    copy.set_operand(0, target);
    append(out, copy);
  }
}

void ModuleEditor::append_global(std::vector<std::uint32_t>& out,
                                 const Instruction& instruction) const {
  switch (instruction.op()) {
    case spv::Op::OpMemoryModel: {
      Instruction model = instruction;
      if (device_addresses_) {
        model.set_operand(
            0, static_cast<std::uint32_t>(spv::AddressingModel::PhysicalStorageBuffer64));
      }
      append(out, model);
      break;
    }
    case spv::Op::OpEntryPoint:
      append(out, edited_entry(instruction));
      break;
    case spv::Op::OpExecutionMode:
    case spv::Op::OpExecutionModeId:
      append_execution_mode(out, instruction);
      break;
    default:
      append(out, instruction);
      break;
  }
}

std::vector<std::uint32_t> ModuleEditor::words() const {
  using spv::Op;
  const std::vector<Instruction>& globals = module_.globals();
  const std::size_t capabilities_end =
      after_last(globals, 0, [](const Instruction& i) { return i.op() == Op::OpCapability; });
  const std::size_t extensions_end = after_last(
      globals, capabilities_end,
      [](const Instruction& i) { return i.op() == Op::OpExtension || i.op() == Op::OpCapability; });
  const std::size_t entries_end =
      after_last(globals, 0, [](const Instruction& i) { return i.op() == Op::OpEntryPoint; });
  const std::size_t preamble_end = after_last(globals, 0, is_preamble);
  const bool has_capability =
      module_.has_capability(spv::Capability::PhysicalStorageBufferAddresses);
  const bool has_extension = std::ranges::any_of(globals, [](const Instruction& i) {
    return i.op() == Op::OpExtension && i.string_operand(0) == kAddressExtension;
  });

  std::vector<std::uint32_t> out = module_.header();
  out[3] = types_.bound();
  for (std::size_t i = 0; i <= globals.size(); ++i) {
    if (i == capabilities_end && device_addresses_ && !has_capability) {
      constexpr auto kCapability =
          static_cast<std::uint32_t>(spv::Capability::PhysicalStorageBufferAddresses);
      append(out, Instruction(Op::OpCapability, std::vector{kCapability}));
    }
    if (i == extensions_end && device_addresses_ && !has_extension &&
        module_.version() < kVersion15) {
      append(out, Instruction(Op::OpExtension, string_words(kAddressExtension)));
    }
    if (i == entries_end) {
      for (const Instruction& mode : modes_) {
        append(out, mode);
      }
    }
    if (i == preamble_end) {
      for (const Instruction& decoration : types_.new_decorations()) {
        append(out, decoration);
      }
    }
    if (i < globals.size()) {
      append_global(out, globals[i]);
    }
  }
  for (const Instruction& created : types_.new_globals()) {
    append(out, created);
  }
  const auto append_all = [&](const std::vector<Instruction>& code) {
    for (const Instruction& instruction : code) {
      append(out, instruction);
    }
  };
  for (const Function& function : module_.functions()) {
    const auto edited = replaced_.find(function.id);
    append_all(edited != replaced_.end() ? edited->second : function.code);
  }
  for (const std::vector<Instruction>& code : added_) {
    append_all(code);
  }
  append_all(module_.trailing());
  return out;
}

}  // namespace a2rt::spirv
