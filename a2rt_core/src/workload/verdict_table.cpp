#include <algorithm>
#include <fstream>

#include "a2rt/base/error.h"
#include "a2rt/workload/verdicts.h"
#include "byte_reader.h"
#include "mapped_file.h"
#include "temporary_file.h"

namespace a2rt {
namespace {

using capture::VerdictAction;
using capture::VerdictDispatchHeader;
using capture::VerdictEntry;
using capture::VerdictFileHeader;

constexpr VerdictEntry kKeepEntry{static_cast<std::uint32_t>(VerdictAction::kKeep), 0, 0, 0};

template <class T>
void put(std::ofstream& out, const T* data, std::size_t count) {
  out.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(count * sizeof(T)));
}

}  // namespace

VerdictTable::VerdictTable(const Workload& workload, std::span<const VerdictEntry> entries) {
  A2RT_CHECK(entries.size() == workload.rays.size(), "one verdict per ray");
  for (std::uint32_t d = 0; d < workload.dispatches.size(); ++d) {
    const Dispatch& dispatch = workload.dispatches[d];
    DispatchTable table{d, {}, {}};
    for (std::uint64_t i = dispatch.first_ray; i < dispatch.first_ray + dispatch.ray_count; ++i) {
      const Ray& ray = workload.rays[i];
      if (keeps(entries[i])) {
        continue;
      }
      if (table.launches.size() <= ray.launch) {
        table.launches.resize(ray.launch + 1);
      }
      Launch& launch = table.launches[ray.launch];
      if (launch.count == 0) {
        launch.first = static_cast<std::uint32_t>(table.entries.size());
      }
      // A pixel shaded twice begins its ordinals again; the later ray's entry counts.
      launch.count = std::max(launch.count, ray.ordinal + 1);
      table.entries.resize(
          std::max<std::size_t>(table.entries.size(), std::size_t{launch.first} + launch.count),
          kKeepEntry);
      table.entries[launch.first + ray.ordinal] = entries[i];
    }
    if (!table.entries.empty()) {
      dispatches_.push_back(std::move(table));
    }
  }
}

VerdictTable VerdictTable::read(const std::filesystem::path& file) {
  const MappedFile mapped(file);
  ByteReader in(mapped.bytes(), file.string());
  const auto header = in.get<VerdictFileHeader>("the header");
  if (header.magic != capture::kVerdictMagic) {
    throw UserError(file.string() + ": not a verdict file (wrong magic number)");
  }
  if (header.version != capture::kFormatVersion) {
    throw UserError(file.string() + ": verdict format version " + std::to_string(header.version) +
                    ", this program reads version " + std::to_string(capture::kFormatVersion));
  }
  VerdictTable all;
  for (std::uint32_t i = 0; i < header.dispatches; ++i) {
    const auto dispatch = in.get<VerdictDispatchHeader>("a dispatch header");
    DispatchTable table{dispatch.dispatch, {}, {}};
    in.get_rows(table.launches, dispatch.launches, "launches");
    in.get_rows(table.entries, dispatch.entries, "entries");
    for (const Launch& launch : table.launches) {
      if (std::uint64_t{launch.first} + launch.count > table.entries.size()) {
        in.fail("a launch names entries that are not there");
      }
    }
    all.dispatches_.push_back(std::move(table));
  }
  return all;
}

void VerdictTable::write(const std::filesystem::path& file) const {
  TemporaryFile temporary(file);
  {
    std::ofstream out(temporary.path(), std::ios::binary);
    const VerdictFileHeader header{capture::kVerdictMagic, capture::kFormatVersion,
                                   static_cast<std::uint32_t>(dispatches_.size()), 0};
    put(out, &header, 1);
    for (const DispatchTable& table : dispatches_) {
      const VerdictDispatchHeader dispatch{table.dispatch,
                                           static_cast<std::uint32_t>(table.launches.size()),
                                           static_cast<std::uint32_t>(table.entries.size()), 0};
      put(out, &dispatch, 1);
      put(out, table.launches.data(), table.launches.size());
      put(out, table.entries.data(), table.entries.size());
    }
    if (!out.flush()) {
      throw UserError("cannot write '" + file.string() +
                      "'; check that the folder exists and the disk has room");
    }
  }
  temporary.commit();
}

VerdictEntry VerdictTable::find(std::uint32_t dispatch, std::uint32_t launch,
                                std::uint32_t ordinal) const {
  const auto found =
      std::find_if(dispatches_.begin(), dispatches_.end(),
                   [&](const DispatchTable& table) { return table.dispatch == dispatch; });
  if (found == dispatches_.end() || launch >= found->launches.size() ||
      ordinal >= found->launches[launch].count) {
    return kKeepEntry;
  }
  return found->entries[found->launches[launch].first + ordinal];
}

}  // namespace a2rt
