#include "a2rt/workload/import.h"

#include <algorithm>
#include <set>

#include "a2rt/base/error.h"
#include "a2rt/workload/exact_walk.h"
#include "a2rt/workload/reference.h"
#include "a2rt/workload/validate.h"
#include "import_launch.h"
#include "import_manifest.h"
#include "import_records.h"
#include "mapped_file.h"
#include "parallel.h"

namespace a2rt {
namespace {

using import::DispatchRecords;
using import::LaunchParser;
using import::Manifest;
using import::OpenEnds;

class Importer {
 public:
  Importer(std::span<const std::byte> records, const ImportOptions& options, ImportReport& report,
           Workload& workload, const Manifest& manifest)
      : records_(records),
        options_(options),
        report_(report),
        workload_(workload),
        manifest_(manifest) {}

  void run() {
    check_extent();
    workload_.candidate_first.push_back(0);
    for (std::size_t d = 0; d < manifest_.dispatches.size(); ++d) {
      dispatch(d);
    }
    report_.orphans = open_ends_.orphans;
    report_.lost = manifest_.end.lost_records;
    refuse_losses();
    resolve_open_ends();
    count_rays();
  }

 private:
  void check_extent() const {
    const std::uint64_t available = records_.size() / capture::kUnitBytes;
    if (manifest_.end.units > available) {
      throw UserError("records.bin: cut off: " + std::to_string(available) + " units of " +
                      std::to_string(manifest_.end.units) + "; capture again");
    }
    std::uint64_t last = 0;
    for (const auto& d : manifest_.dispatches) {
      if (d.block.first_unit < last || d.block.first_unit > manifest_.end.units) {
        throw UserError("manifest.bin: the records of dispatch " +
                        std::to_string(d.block.dispatch) + " begin at unit " +
                        std::to_string(d.block.first_unit) + ", out of order or beyond the end");
      }
      last = d.block.first_unit;
    }
    const bool none_before = manifest_.dispatches.empty()
                                 ? manifest_.end.units == 0
                                 : manifest_.dispatches.front().block.first_unit == 0;
    if (!none_before) {
      throw UserError("records.bin: begins with records of no dispatch");
    }
  }

  void dispatch(std::size_t d) {
    const import::RawDispatch& raw = manifest_.dispatches[d];
    const std::uint64_t last = d + 1 < manifest_.dispatches.size()
                                   ? manifest_.dispatches[d + 1].block.first_unit
                                   : manifest_.end.units;
    progress(0.8 * static_cast<double>(raw.block.first_unit), "reading records");
    const DispatchRecords records(records_, raw.block.first_unit, last, raw);
    for (std::size_t kind = 0; kind < report_.records.size(); ++kind) {
      report_.records[kind] += records.counts()[kind];
    }
    check_count(workload_.rays.size() +
                records.counts()[static_cast<std::size_t>(capture::RecordKind::kRay)]);
    Dispatch out{raw.block.frame,           raw.block.width,
                 raw.block.height,          raw.block.depth,
                 workload_.rays.size(),     0,
                 workload_.segments.size(), 0};
    parse(records, raw, static_cast<std::uint32_t>(d));
    out.ray_count = workload_.rays.size() - out.first_ray;
    out.segment_count = workload_.segments.size() - out.first_segment;
    workload_.dispatches.push_back(out);
  }

  void parse(const DispatchRecords& records, const import::RawDispatch& raw, std::uint32_t index) {
    LaunchParser parser(manifest_, raw, index, workload_, open_ends_);
    for (std::size_t i = 0; i < records.size();) {
      const std::uint32_t launch = records[i].launch();
      parser.begin_launch();
      for (; i < records.size() && records[i].launch() == launch; ++i) {
        const import::Record record = records[i];
        check_shader(record.shader());
        parser.record(record);
      }
      parser.end_launch();
    }
  }

  void check_shader(std::uint32_t shader) const {
    if (shader >= workload_.shaders.size()) {
      throw UserError("records.bin: a record of shader " + std::to_string(shader) +
                      ", but the manifest names only " + std::to_string(workload_.shaders.size()));
    }
  }
  static void check_count(std::uint64_t rays) {
    if (rays >= kNone) {
      throw UserError("the capture has more than 4 billion rays; capture fewer pixels or frames");
    }
  }

  void refuse_losses() const {
    if (options_.tolerate_lost) {
      return;
    }
    if (report_.lost > 0) {
      throw UserError(std::to_string(report_.lost) +
                      " records did not fit the layer's buffer and are lost; capture again with a "
                      "larger buffer or fewer pixels, or import with --tolerate-lost");
    }
    if (report_.orphans > 0) {
      throw UserError(std::to_string(report_.orphans) +
                      " records fit no place in the nesting of shader calls: the capture is "
                      "damaged; capture again, or import with --tolerate-lost");
    }
  }

  // Rays whose end no shader saw, and what queries passed over, by walking the driver's nodes.
  void resolve_open_ends() {
    if (open_ends_.unrecorded.empty() && open_ends_.judged_queries.empty()) {
      return;
    }
    const ExactWalk walk(workload_);
    ParallelOptions parallel;
    parallel.progress = [this](double share) {
      progress((0.8 + 0.2 * share) * static_cast<double>(manifest_.end.units),
               "tracing rays without records");
    };
    parallel_batches(open_ends_.unrecorded.size(), parallel,
                     [&](std::uint64_t first, std::uint64_t last) {
                       for (std::uint64_t i = first; i < last; ++i) {
                         infer(walk, open_ends_.unrecorded[i]);
                       }
                     });
    complete_queries(walk);
    warn_unwalkable(walk);
  }

  void infer(const ExactWalk& walk, std::uint32_t index) {
    const Ray& ray = workload_.rays[index];
    if ((ray.flags & kRayOverridden) == 0 && walk.problem(ray.tlas).empty()) {
      Hit hit = walk.walk(ray, candidates_of(workload_, index)).hit;
      hit.state = hit.state == HitState::kHit ? HitState::kHitInferred : HitState::kMiss;
      workload_.driver_hits[index] = hit;
    }
  }

  // Queries leave no record of the candidates they passed over; the walk meets them.
  void complete_queries(const ExactWalk& walk) {
    std::vector<std::uint32_t>& queries = open_ends_.judged_queries;
    std::sort(queries.begin(), queries.end());
    queries.erase(std::unique(queries.begin(), queries.end()), queries.end());
    if (queries.empty()) {
      return;
    }
    std::vector<Candidate> all;
    std::vector<std::uint64_t> first{0};
    auto query = queries.begin();
    for (std::uint32_t i = 0; i < workload_.rays.size(); ++i) {
      const Ray& ray = workload_.rays[i];
      const auto own = candidates_of(workload_, i);
      const bool judged = query != queries.end() && *query == i;
      query += judged ? 1 : 0;
      const bool walkable = judged && walk.problem(ray.tlas).empty() &&
                            (ray.flags & kRayOverridden) == 0 &&
                            workload_.driver_hits[i].state != HitState::kUnknown;
      const WalkResult met = walkable ? walk.walk(ray, own, true) : WalkResult{};
      // A walk that did not use every verdict went astray; the check will say so.
      const bool complete = walkable && met.unused_verdicts == 0;
      const std::span<const Candidate> chosen = complete ? std::span(met.met) : own;
      all.insert(all.end(), chosen.begin(), chosen.end());
      first.push_back(all.size());
    }
    workload_.candidates = std::move(all);
    workload_.candidate_first = std::move(first);
  }

  void warn_unwalkable(const ExactWalk& walk) const {
    std::set<std::uint32_t> seen;
    for (const std::uint32_t index : open_ends_.unrecorded) {
      seen.insert(workload_.rays[index].tlas);
    }
    for (const std::uint32_t tlas : seen) {
      if (!walk.problem(tlas).empty()) {
        report_.warnings.push_back("rays without shader record stay unknown: " +
                                   walk.problem(tlas));
      }
    }
  }

  void count_rays() {
    for (const std::uint32_t index : open_ends_.unrecorded) {
      const HitState state = workload_.driver_hits[index].state;
      report_.inferred_hits += state == HitState::kHitInferred ? 1 : 0;
      report_.inferred_misses += state == HitState::kMiss ? 1 : 0;
    }
    for (std::size_t i = 0; i < workload_.rays.size(); ++i) {
      report_.unknown += workload_.driver_hits[i].state == HitState::kUnknown ? 1U : 0U;
      report_.overridden += (workload_.rays[i].flags & kRayOverridden) != 0 ? 1U : 0U;
    }
  }

  void progress(double units_done, const char* what) const {
    if (options_.progress) {
      const auto units = static_cast<double>(std::max<std::uint64_t>(manifest_.end.units, 1));
      options_.progress(units_done / units, what);
    }
  }

  std::span<const std::byte> records_;
  const ImportOptions& options_;
  ImportReport& report_;
  Workload& workload_;
  const Manifest& manifest_;
  OpenEnds open_ends_;
};

}  // namespace

Workload import_capture(std::span<const std::byte> manifest_bytes,
                        std::span<const std::byte> records, const ImportOptions& options,
                        ImportReport& report) {
  Workload workload;
  const Manifest manifest = import::read_manifest(manifest_bytes, workload);
  workload.provenance.scene = options.scene;
  workload.provenance.workload = options.workload;
  for (const std::string& what : manifest.refused) {
    workload.provenance.refused += (workload.provenance.refused.empty() ? "" : "; ") + what;
    report.warnings.push_back("the layer could not capture: " + what);
  }
  Importer(records, options, report, workload, manifest).run();
  validate(workload, "capture");
  return workload;
}

Workload import_capture(const std::filesystem::path& directory, const ImportOptions& options,
                        ImportReport& report) {
  if (std::filesystem::exists(directory / "manifest.bin.part")) {
    throw UserError(directory.string() +
                    ": the capture is not complete (the program crashed or was killed); run it "
                    "again");
  }
  if (!std::filesystem::exists(directory / "manifest.bin")) {
    throw UserError(directory.string() +
                    ": no capture: manifest.bin is missing; name the directory that the layer "
                    "wrote (A2RT_CAPTURE)");
  }
  const MappedFile manifest(directory / "manifest.bin");
  const MappedFile records(directory / "records.bin");
  try {
    return import_capture(manifest.bytes(), records.bytes(), options, report);
  } catch (const UserError& error) {
    throw UserError(directory.string() + ": " + error.what());
  }
}

}  // namespace a2rt
