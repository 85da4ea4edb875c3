#include "hit_report.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "a2rt/workload/compare.h"
#include "a2rt/workload/verdicts.h"

namespace a2rt::tools {

std::uint64_t HitReport::lost() const {
  for (const auto& [name, count] : categories) {
    if (name == match_name(Match::kLost)) {
      return count;
    }
  }
  return 0;
}

void HitReport::print() const {
  std::printf("  against the driver:");
  for (const auto& [name, count] : categories) {
    if (count > 0) {
      std::printf(" %s %llu", name.c_str(), static_cast<unsigned long long>(count));
    }
  }
  std::printf("\n");
}

nlohmann::ordered_json HitReport::match_json() const {
  nlohmann::ordered_json all = nlohmann::ordered_json::object();
  for (const auto& [name, count] : categories) {
    all[name == "same" ? "equal" : name] = count;
  }
  return all;
}

nlohmann::ordered_json HitReport::verdicts_json() const {
  return {{"entries", entries}, {"changed", changed}, {"unrealisable", unrealisable}};
}

HitReport report_hits(const Workload& workload, const std::vector<Hit>& hits,
                      const std::string& verdicts, const std::string& previous) {
  MatchReport matches;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    matches.add(workload, i, hits[i]);
  }
  HitReport report;
  for (std::size_t m = 0; m < kMatchKinds; ++m) {
    report.categories.emplace_back(match_name(static_cast<Match>(m)), matches.counts[m]);
  }
  if (!verdicts.empty()) {
    const VerdictTable before = previous.empty() ? VerdictTable{} : VerdictTable::read(previous);
    VerdictSummary summary;
    const std::vector<capture::VerdictEntry> entries =
        decide_verdicts(workload, hits, before, summary);
    VerdictTable(workload, entries).write(verdicts);
    report.entries = summary.entries;
    report.changed = summary.changed;
    report.unrealisable = summary.unrealisable;
  }
  return report;
}

}  // namespace a2rt::tools
