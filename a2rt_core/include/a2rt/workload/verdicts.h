// Verdicts: what the layer must do to each ray so that the program draws what a unit would draw.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "a2rt/capture/records.h"
#include "a2rt/workload/workload.h"

namespace a2rt {

// Whether the driver's own traversal of the ray is right.
inline bool keeps(const capture::VerdictEntry& entry) {
  return entry.action == static_cast<std::uint32_t>(capture::VerdictAction::kKeep);
}

// A verdict file in memory (layout: capture/records.h). Rays that it does not name are kept.
class VerdictTable {
 public:
  VerdictTable() = default;
  // From one entry per ray of the workload. Entries that keep are left out where nothing follows
  // them, so equal decisions give equal bytes.
  VerdictTable(const Workload& workload, std::span<const capture::VerdictEntry> entries);
  // Throws UserError naming file and byte if the file is missing, foreign, newer or cut off.
  static VerdictTable read(const std::filesystem::path& file);
  // Written to a temporary name and renamed. Throws UserError.
  void write(const std::filesystem::path& file) const;

  // kKeep for rays that the table does not name.
  capture::VerdictEntry find(std::uint32_t dispatch, std::uint32_t launch,
                             std::uint32_t ordinal) const;

 private:
  struct Launch {
    std::uint32_t first = 0, count = 0;
  };
  struct DispatchTable {
    std::uint32_t dispatch = 0;
    std::vector<Launch> launches;
    std::vector<capture::VerdictEntry> entries;
  };
  std::vector<DispatchTable> dispatches_;  // ascending, only those with entries
};

struct VerdictSummary {
  std::uint64_t entries = 0;       // that do not keep
  std::uint64_t changed = 0;       // that differ from the previous pass
  std::uint64_t unrealisable = 0;  // no interval makes the driver find the unit's hit: its own
                                   // boxes hide it, or another primitive lies at the same distance
};

// One entry per ray. `hits` are the unit's answers; `previous` are the verdicts under which the
// workload was captured (empty table: none). Where the recorded hit is the unit's, the previous
// entry stands; it also stands where the unit differs only because it met a candidate that no
// shader could judge under that entry (else passes would alternate). Otherwise a miss is forced, or
// an interval is chosen that begins just below the unit's hit; if the driver's nodes are there, it
// is proved by the exact walk.
std::vector<capture::VerdictEntry> decide_verdicts(const Workload& workload,
                                                   std::span<const Hit> hits,
                                                   const VerdictTable& previous,
                                                   VerdictSummary& summary);

}  // namespace a2rt
