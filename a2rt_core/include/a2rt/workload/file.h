// Workload files: HDF5, described in FORMAT.md beside this header.
#pragma once

#include <cstdint>
#include <filesystem>

#include "a2rt/workload/workload.h"

namespace a2rt {

// Raised when the meaning of the content changes; readers refuse newer files.
inline constexpr std::uint32_t kWorkloadFormatVersion = 1;

struct WriteOptions {
  bool driver_nodes = true;  // the driver's trees, needed by the exact walk only
  int deflate = 1;           // level for geometry and trees; 0 = none. Rays are never compressed.
};

// Writes `workload` to a temporary name beside `file` and renames it once it is complete, so that
// `file` is never half written. Throws UserError if the workload is inconsistent (see validate.h)
// or the disk refuses.
void write_workload(const Workload& workload, const std::filesystem::path& file,
                    const WriteOptions& options = {});

struct ReadOptions {
  bool primitives = true;    // triangles and AABBs; without them, primitive ids are not checked
  bool driver_nodes = true;  // trees of the driver, where the file has them
  bool rays = true;          // rays, hits, candidates and segments
};

// Reads and validates a workload. Throws UserError naming file, object and row if the file is not
// a workload, newer than this program, truncated, damaged (its checksum is compared first) or
// inconsistent.
Workload read_workload(const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace a2rt
