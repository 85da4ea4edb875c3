// Verdict files with any content are read or refused.
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "a2rt/base/error.h"
#include "a2rt/workload/verdicts.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto kFile =
      std::filesystem::temp_directory_path() / ("a2rt_fuzz_verdicts_" + std::to_string(::getpid()));
  std::ofstream(kFile, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    const auto table = a2rt::VerdictTable::read(kFile);
    for (std::uint32_t i = 0; i < 8; ++i) {
      table.find(i % 2, i, i % 3);
    }
  } catch (const a2rt::UserError&) {
    // The one answer to damage.
  }
  return 0;
}
