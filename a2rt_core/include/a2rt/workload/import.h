// Raw captures of the Vulkan layer (capture/records.h, capture/manifest.h) as workloads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "a2rt/workload/workload.h"

namespace a2rt {

struct ImportOptions {
  std::string scene, workload;  // names for the provenance
  // Import what is there although records were lost or cannot be placed. Such a workload is good
  // for looking at, not for measuring.
  bool tolerate_lost = false;
  // Called with the share done, 0 to 1, and what is being done.
  std::function<void(double, const char*)> progress;
};

struct ImportReport {
  std::array<std::uint64_t, 10> records{};  // by capture::RecordKind
  std::uint64_t lost = 0;                   // records that did not fit the layer's buffer
  std::uint64_t orphans = 0;                // records that fit no place in the nesting of calls
  std::uint64_t inferred_hits = 0;          // hits without shader record, ids from the exact walk
  std::uint64_t inferred_misses = 0;        // misses without shader record
  std::uint64_t unknown = 0;     // rays of which nothing is known: unfinished queries, or no record
                                 // and no usable driver nodes or a verdict applied
  std::uint64_t overridden = 0;  // rays to which a verdict was applied
  std::vector<std::string> warnings;  // for the user, one sentence each
};

// Reads DIR/manifest.bin and DIR/records.bin. Memory: the workload itself, plus eight bytes per
// record, plus mapped pages. Throws UserError naming file and byte if a file is missing, cut off,
// newer or inconsistent, and if records were lost or orphaned (unless tolerated).
Workload import_capture(const std::filesystem::path& directory, const ImportOptions& options,
                        ImportReport& report);

// The same from memory; names stand for the files in messages.
Workload import_capture(std::span<const std::byte> manifest, std::span<const std::byte> records,
                        const ImportOptions& options, ImportReport& report);

}  // namespace a2rt
