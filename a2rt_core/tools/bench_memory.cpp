#include "bench_memory.h"

#include <malloc.h>

#include <fstream>
#include <string>

namespace a2rt::tools {
namespace {

// A value of /proc/self/status, which is in kB; 0 if it is not there.
std::uint64_t status_bytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word == key + ":") {
      std::uint64_t kilobytes = 0;
      status >> kilobytes;
      return kilobytes * 1024;
    }
  }
  return 0;
}

}  // namespace

PeakMemory::PeakMemory() {
  // Memory freed by earlier steps but kept by the allocator would hide what this step takes.
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
  before_ = status_bytes("VmRSS");
}

std::uint64_t PeakMemory::growth() const {
  const std::uint64_t peak = status_bytes("VmHWM");
  return peak > before_ ? peak - before_ : 0;
}

}  // namespace a2rt::tools
