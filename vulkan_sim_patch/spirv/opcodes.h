// What the SPIR-V grammar says about each opcode, generated at build time from
// spirv.core.grammar.json (see generate_opcodes.py).
#pragma once

#include <cstdint>
#include <string>

namespace a2rt::spirv {

enum class OpcodeClass : std::uint8_t {
  kAnnotation,
  kDebug,
  kModeSetting,
  kExtension,
  kType,
  kConstant,
  kOther
};

struct OpcodeInfo {
  std::uint16_t opcode;
  const char* name;
  bool has_type;
  bool has_result;
  std::uint16_t min_words;  // with the first word
  OpcodeClass group;
};

// Null for an opcode the grammar of this build does not know.
const OpcodeInfo* opcode_info(std::uint32_t opcode);
// "OpLoad", or "opcode 6400" for an unknown one.
std::string opcode_name(std::uint32_t opcode);

}  // namespace a2rt::spirv
