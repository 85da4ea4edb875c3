// The one error this library throws.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

namespace a2rt::spirv {

// A module that is damaged or that cannot be rewritten. The message names the word offset (words
// counted from the start of the module), the instruction and the reason.
class SpirvError : public std::runtime_error {
 public:
  SpirvError(std::size_t word_offset, const std::string& reason)
      : std::runtime_error("SPIR-V module, word " + std::to_string(word_offset) + ": " + reason),
        word_offset_(word_offset) {}
  std::size_t word_offset() const { return word_offset_; }

 private:
  std::size_t word_offset_;
};

}  // namespace a2rt::spirv
