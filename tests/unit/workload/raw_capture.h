// Builds raw captures by hand, as the layer would write them.
#pragma once

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "a2rt/capture/manifest.h"
#include "a2rt/capture/records.h"
#include "a2rt/workload/import.h"
#include "a2rt/workload/workload.h"

namespace a2rt::testing {

using Bytes = std::vector<std::byte>;

class RawManifest {
 public:
  RawManifest();
  void driver(const std::string& command_line);
  void shader(std::uint32_t index, capture::Stage stage);
  void query_site(std::uint32_t shader, std::uint32_t site);
  void blas(std::uint64_t id, std::uint64_t address, const Blas& blas);
  // Instance i refers to blas_addresses[instances[i].blas].
  void tlas(std::uint64_t id, std::uint64_t address, const Tlas& tlas,
            const std::vector<std::uint64_t>& blas_addresses);
  void copy(std::uint64_t from, std::uint64_t to, std::uint64_t id);
  void destroy(std::uint64_t address);
  void dispatch(std::uint32_t width, std::uint32_t height, std::uint64_t first_unit,
                const std::vector<capture::SiteBinding>& sites = {});
  void refused(const std::string& what);
  void end(std::uint64_t units, std::uint64_t lost = 0);
  const Bytes& bytes() const { return bytes_; }

 private:
  void block(capture::BlockType type, const Bytes& payload);
  Bytes bytes_;
  std::uint32_t dispatches_ = 0;
};

// Records of one dispatch after the other, in the order of the calls.
class RawRecords {
 public:
  void begin_dispatch(std::uint32_t dispatch) { dispatch_ = dispatch; }
  // Whose records follow.
  RawRecords& by(capture::Stage stage, std::uint32_t shader, std::uint32_t launch = 0);
  RawRecords& ray(const Ray& ray, std::uint32_t site = 0, bool overridden = false);
  RawRecords& hit(const Hit& hit);
  RawRecords& miss();
  RawRecords& any_hit(const Hit& candidate, capture::AnyHitVerdict verdict);
  RawRecords& report(const Hit& candidate, bool accepted);
  RawRecords& segment(std::uint32_t alu);
  RawRecords& end(std::uint32_t alu = 0);
  // The query records that follow, until the next by(), name the ray of ordinal `ordinal`;
  // otherwise they name the latest one.
  RawRecords& of_query(std::uint32_t ordinal);
  RawRecords& step(const Hit& committed, bool more);
  RawRecords& query_verdict(const Hit& candidate, bool generated, capture::AnyHitVerdict verdict);

  std::uint64_t units() const { return bytes_.size() / capture::kUnitBytes; }
  const Bytes& bytes() const { return bytes_; }
  Bytes& bytes() { return bytes_; }

 private:
  void head(capture::RecordKind kind);
  void unit(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);
  void hit_units(const Hit& hit, std::uint32_t last);
  Bytes bytes_;
  std::uint32_t dispatch_ = 0, shader_ = 0, launch_ = 0;
  capture::Stage stage_ = capture::Stage::kRayGeneration;
  std::vector<std::uint32_t> ordinals_;
  std::optional<std::uint32_t> query_;
};

// Imports from memory; `report` may be null.
Workload import_raw(const RawManifest& manifest, const RawRecords& records,
                    const ImportOptions& options = {}, ImportReport* report = nullptr);
// The message of the UserError an import throws, or "no error".
std::string import_error(std::span<const std::byte> manifest, std::span<const std::byte> records,
                         const ImportOptions& options = {});

}  // namespace a2rt::testing
