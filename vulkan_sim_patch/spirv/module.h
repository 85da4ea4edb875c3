// A SPIR-V module as a list of instructions, parsed with every bound checked.
//
// The parser knows of each instruction only its length and which words are its type and its result;
// everything else passes through untouched, so that writing an unedited module gives back its
// words.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <spirv/unified1/spirv.hpp11>
#include <string>
#include <unordered_map>
#include <vector>

#include "spirv/error.h"

namespace a2rt::spirv {

using Id = std::uint32_t;  // 0 is no id

class Instruction {
 public:
  // `words` with the first word (length and opcode) filled in; `offset` in the source module.
  Instruction(std::vector<std::uint32_t> words, std::size_t offset);
  // A new instruction; `operands` are all words after the first, with type and result.
  Instruction(spv::Op op, std::span<const std::uint32_t> operands, std::size_t offset = 0);

  spv::Op op() const { return static_cast<spv::Op>(words_[0] & 0xffffu); }
  Id type() const { return type_; }
  Id result() const { return result_; }
  std::size_t offset() const { return offset_; }
  const std::vector<std::uint32_t>& words() const { return words_; }

  // Operands after type and result, from 0. operand() throws SpirvError if there is no such one.
  std::size_t operand_count() const { return words_.size() - first_operand_; }
  std::uint32_t operand(std::size_t index) const;
  std::span<const std::uint32_t> operands() const {
    return std::span(words_).subspan(first_operand_);
  }
  void set_operand(std::size_t index, std::uint32_t value);
  // The literal string that starts at operand `index`; `end` is the operand after it.
  std::string string_operand(std::size_t index, std::size_t* end = nullptr) const;

  [[noreturn]] void fail(const std::string& reason) const;

 private:
  void find_ids();

  std::vector<std::uint32_t> words_;
  std::size_t offset_ = 0;
  std::size_t first_operand_ = 1;
  Id type_ = 0;
  Id result_ = 0;
};

// From OpFunction (or the OpLine before it) to OpFunctionEnd.
struct Function {
  Id id = 0;
  std::vector<Instruction> code;
};

// Immutable once parsed: pointers to its instructions stay valid, also when it is moved.
class Module {
 public:
  Module(Module&&) = default;
  Module& operator=(Module&&) = default;
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;

  static constexpr std::size_t kHeaderWords = 5;
  // Universal limit on ids (SPIR-V 2.16): bounds what a damaged header can make us allocate.
  static constexpr std::uint32_t kMaxBound = 0x3fffff;

  // Throws SpirvError naming the word offset if `words` is not a well-formed stream.
  static Module parse(std::span<const std::uint32_t> words);

  std::uint32_t version() const { return header_[1]; }
  std::uint32_t bound() const { return header_[3]; }
  const std::vector<std::uint32_t>& header() const { return header_; }
  const std::vector<Instruction>& globals() const { return globals_; }
  const std::vector<Function>& functions() const { return functions_; }
  // What follows the last function (debug lines); empty in practice.
  const std::vector<Instruction>& trailing() const { return trailing_; }
  std::vector<std::uint32_t> words() const;

  // Null if no instruction of the module defines `id`.
  const Instruction* definition(Id id) const;
  // Type of a value; 0 if it has none or is not defined.
  Id type_of(Id id) const;
  const Function* function(Id id) const;
  bool has_capability(spv::Capability capability) const;
  // The opcode that declares type `type`; OpNop if it is not defined.
  spv::Op type_op(Id type) const;

  // Opcodes outside the grammar of this build, each once.
  const std::vector<std::uint32_t>& unknown_opcodes() const { return unknown_opcodes_; }

 private:
  Module() = default;
  void read_instructions(std::span<const std::uint32_t> words);
  void split(std::vector<Instruction> all);
  void index(const Instruction& instruction);

  std::vector<std::uint32_t> header_;
  std::vector<Instruction> globals_;
  std::vector<Function> functions_;
  std::vector<Instruction> trailing_;
  std::unordered_map<Id, const Instruction*> definitions_;
  std::unordered_map<Id, std::size_t> function_index_;
  std::vector<std::uint32_t> unknown_opcodes_;
};

void append(std::vector<std::uint32_t>& words, const Instruction& instruction);
// Words of a literal string, zero-padded.
std::vector<std::uint32_t> string_words(const std::string& text);
bool is_debug_line(const Instruction& instruction);

}  // namespace a2rt::spirv
