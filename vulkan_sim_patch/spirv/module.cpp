#include "spirv/module.h"

#include <algorithm>

#include "spirv/opcodes.h"

namespace a2rt::spirv {

Instruction::Instruction(std::vector<std::uint32_t> words, std::size_t offset)
    : words_(std::move(words)), offset_(offset) {
  find_ids();
}

Instruction::Instruction(spv::Op op, std::span<const std::uint32_t> operands, std::size_t offset)
    : offset_(offset) {
  const std::size_t count = operands.size() + 1;
  if (count > 0xffffu) {
    throw SpirvError(offset, opcode_name(static_cast<std::uint32_t>(op)) + " of " +
                                 std::to_string(count) + " words is longer than SPIR-V allows");
  }
  words_.reserve(count);
  words_.push_back(static_cast<std::uint32_t>(count << 16) | static_cast<std::uint32_t>(op));
  words_.insert(words_.end(), operands.begin(), operands.end());
  find_ids();
}

void Instruction::find_ids() {
  const OpcodeInfo* const info = opcode_info(words_[0] & 0xffffu);
  if (info == nullptr) {
    return;
  }
  if (words_.size() < info->min_words) {
    fail("has " + std::to_string(words_.size()) + " words, needs " +
         std::to_string(info->min_words));
  }
  if (info->has_type) {
    type_ = words_[first_operand_++];
  }
  if (info->has_result) {
    result_ = words_[first_operand_++];
  }
}

void Instruction::fail(const std::string& reason) const {
  throw SpirvError(offset_, opcode_name(words_[0] & 0xffffu) + " " + reason);
}

std::uint32_t Instruction::operand(std::size_t index) const {
  if (index >= operand_count()) {
    fail("has no operand " + std::to_string(index));
  }
  return words_[first_operand_ + index];
}

void Instruction::set_operand(std::size_t index, std::uint32_t value) {
  if (index >= operand_count()) {
    fail("has no operand " + std::to_string(index));
  }
  words_[first_operand_ + index] = value;
}

std::string Instruction::string_operand(std::size_t index, std::size_t* end) const {
  std::string text;
  for (std::size_t i = index; i < operand_count(); ++i) {
    const std::uint32_t word = operand(i);
    for (unsigned byte = 0; byte < 4; ++byte) {
      const char c = static_cast<char>((word >> (8 * byte)) & 0xffu);
      if (c == '\0') {
        if (end != nullptr) {
          *end = i + 1;
        }
        return text;
      }
      text.push_back(c);
    }
  }
  fail("has a string without end");
}

Module Module::parse(std::span<const std::uint32_t> words) {
  if (words.size() < kHeaderWords) {
    throw SpirvError(words.size(), "the module ends inside its header of five words");
  }
  if (words[0] != spv::MagicNumber) {
    throw SpirvError(0, words[0] == 0x03022307u ? "the module has the other byte order"
                                                : "this is not SPIR-V (wrong magic number)");
  }
  if ((words[1] >> 16) != 1u) {
    throw SpirvError(1, "SPIR-V version " + std::to_string(words[1] >> 16) + " is not known");
  }
  if (words[3] == 0 || words[3] > kMaxBound) {
    throw SpirvError(
        3, "id bound " + std::to_string(words[3]) + " is outside 1.." + std::to_string(kMaxBound));
  }
  Module module;
  module.header_.assign(words.begin(), words.begin() + kHeaderWords);
  module.read_instructions(words);
  return module;
}

void Module::read_instructions(std::span<const std::uint32_t> words) {
  std::vector<Instruction> all;
  for (std::size_t at = kHeaderWords; at < words.size();) {
    const std::size_t count = words[at] >> 16;
    const std::uint32_t opcode = words[at] & 0xffffu;
    if (count == 0) {
      throw SpirvError(at, opcode_name(opcode) + " has a length of 0 words");
    }
    if (count > words.size() - at) {
      throw SpirvError(at, opcode_name(opcode) + " of " + std::to_string(count) +
                               " words runs past the end of the module (" +
                               std::to_string(words.size()) + " words)");
    }
    if (opcode_info(opcode) == nullptr &&
        std::ranges::find(unknown_opcodes_, opcode) == unknown_opcodes_.end()) {
      unknown_opcodes_.push_back(opcode);
    }
    const auto slice = words.subspan(at, count);
    all.emplace_back(std::vector<std::uint32_t>(slice.begin(), slice.end()), at);
    at += count;
  }
  split(std::move(all));
}

void Module::split(std::vector<Instruction> all) {
  std::vector<Instruction> pending;  // debug lines that belong to whatever comes next
  bool inside = false;
  for (Instruction& instruction : all) {
    const spv::Op op = instruction.op();
    if (op == spv::Op::OpFunction) {
      if (inside) {
        instruction.fail("stands inside a function");
      }
      inside = true;
      functions_.push_back({instruction.result(), std::move(pending)});
      pending.clear();
    } else if (!inside && op == spv::Op::OpFunctionEnd) {
      instruction.fail("stands outside of a function");
    }
    if (inside) {
      functions_.back().code.push_back(std::move(instruction));
      inside = op != spv::Op::OpFunctionEnd;
    } else if (!functions_.empty() || is_debug_line(instruction)) {
      pending.push_back(std::move(instruction));
    } else {
      std::ranges::move(pending, std::back_inserter(globals_));
      pending.clear();
      globals_.push_back(std::move(instruction));
    }
  }
  if (inside) {
    functions_.back().code.back().fail("is the last instruction, but its function has not ended");
  }
  trailing_ = std::move(pending);
  for (const Instruction& instruction : globals_) {
    index(instruction);
  }
  for (std::size_t i = 0; i < functions_.size(); ++i) {
    function_index_.emplace(functions_[i].id, i);
    for (const Instruction& instruction : functions_[i].code) {
      index(instruction);
    }
  }
}

void Module::index(const Instruction& instruction) {
  const Id id = instruction.result();
  const OpcodeInfo* const info = opcode_info(static_cast<std::uint32_t>(instruction.op()));
  if (info == nullptr || !info->has_result) {
    return;
  }
  if (id == 0 || id >= bound()) {
    instruction.fail("defines id " + std::to_string(id) + " outside the bound " +
                     std::to_string(bound()));
  }
  const auto [entry, fresh] = definitions_.emplace(id, &instruction);
  if (!fresh) {
    instruction.fail("defines id " + std::to_string(id) + " again; it was defined at word " +
                     std::to_string(entry->second->offset()));
  }
}

std::vector<std::uint32_t> Module::words() const {
  std::vector<std::uint32_t> out = header_;
  for (const Instruction& instruction : globals_) {
    append(out, instruction);
  }
  for (const Function& function : functions_) {
    for (const Instruction& instruction : function.code) {
      append(out, instruction);
    }
  }
  for (const Instruction& instruction : trailing_) {
    append(out, instruction);
  }
  return out;
}

const Instruction* Module::definition(Id id) const {
  const auto found = definitions_.find(id);
  return found == definitions_.end() ? nullptr : found->second;
}

Id Module::type_of(Id id) const {
  const Instruction* const defined = definition(id);
  return defined == nullptr ? 0 : defined->type();
}

const Function* Module::function(Id id) const {
  const auto found = function_index_.find(id);
  return found == function_index_.end() ? nullptr : &functions_[found->second];
}

bool Module::has_capability(spv::Capability capability) const {
  return std::ranges::any_of(globals_, [&](const Instruction& i) {
    return i.op() == spv::Op::OpCapability &&
           i.operand(0) == static_cast<std::uint32_t>(capability);
  });
}

spv::Op Module::type_op(Id type) const {
  const Instruction* const defined = definition(type);
  return defined == nullptr ? spv::Op::OpNop : defined->op();
}

void append(std::vector<std::uint32_t>& words, const Instruction& instruction) {
  words.insert(words.end(), instruction.words().begin(), instruction.words().end());
}

std::vector<std::uint32_t> string_words(const std::string& text) {
  std::vector<std::uint32_t> words(text.size() / 4 + 1, 0);
  for (std::size_t i = 0; i < text.size(); ++i) {
    words[i / 4] |= static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]))
                    << (8 * (i % 4));
  }
  return words;
}

bool is_debug_line(const Instruction& instruction) {
  return instruction.op() == spv::Op::OpLine || instruction.op() == spv::Op::OpNoLine;
}

}  // namespace a2rt::spirv
