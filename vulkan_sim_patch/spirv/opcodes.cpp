#include "spirv/opcodes.h"

#include <algorithm>
#include <iterator>

namespace a2rt::spirv {
namespace {

constexpr OpcodeInfo kTable[] = {
#include "opcode_rows.inc"
};

}  // namespace

const OpcodeInfo* opcode_info(std::uint32_t opcode) {
  const auto* const end = std::end(kTable);
  const auto* const found =
      std::lower_bound(std::begin(kTable), end, opcode,
                       [](const OpcodeInfo& row, std::uint32_t op) { return row.opcode < op; });
  return found != end && found->opcode == opcode ? found : nullptr;
}

std::string opcode_name(std::uint32_t opcode) {
  const OpcodeInfo* const info = opcode_info(opcode);
  return info != nullptr ? info->name : "opcode " + std::to_string(opcode);
}

}  // namespace a2rt::spirv
