// How much memory a step of the program needs at its worst.
#pragma once

#include <cstdint>

namespace a2rt::tools {

// Growth of the resident set from its construction to its highest point since. Linux lets a process
// reset its own high-water mark; where that is refused, the mark of the whole run is what is left,
// and growth() may count earlier steps (never too little).
class PeakMemory {
 public:
  PeakMemory();
  std::uint64_t growth() const;  // bytes

 private:
  std::uint64_t before_;
};

}  // namespace a2rt::tools
