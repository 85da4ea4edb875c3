#include <cstring>
#include <new>
#include <stdexcept>

#include "a2rt/base/error.h"
#include "a2rt/workload/file.h"
#include "a2rt/workload/validate.h"
#include "file_types.h"
#include "mapped_file.h"

namespace a2rt {
namespace {

// Refuses a damaged file before HDF5, which trusts its input, has seen it. Files of other writers
// have no user block and are taken as they are.
void check_seal(const std::filesystem::path& path) {
  const MappedFile mapped(path);
  const auto bytes = mapped.bytes();
  file::UserBlock block{};
  if (bytes.size() >= sizeof block) {
    std::memcpy(&block, bytes.data(), sizeof block);
  }
  if (std::memcmp(block.magic, file::kMagic, sizeof block.magic) != 0) {
    return;
  }
  const std::string name = path.string();
  const std::size_t available =
      bytes.size() > file::kUserBlockBytes ? bytes.size() - file::kUserBlockBytes : 0;
  if (block.payload_bytes != available) {
    throw UserError(name + ": truncated: " + std::to_string(available) + " bytes of " +
                    std::to_string(block.payload_bytes) + "; capture or copy it again");
  }
  const auto payload = bytes.subspan(file::kUserBlockBytes);
  if (file::hash_bytes(payload.data(), payload.size()) != block.payload_hash) {
    throw UserError(name +
                    ": damaged: the checksum differs; capture or copy it again (to change a "
                    "workload, write a new file instead of editing this one)");
  }
}

class Reader {
 public:
  Reader(const h5::Location& root, const ReadOptions& options) : root_(root), options_(options) {}

  Provenance provenance() const {
    const auto group = root_.open_group("provenance");
    return {group.text_attribute("program"),
            group.text_attribute("driver"),
            group.text_attribute("command_line"),
            group.text_attribute("scene"),
            group.text_attribute("workload"),
            group.text_attribute("refused"),
            group.integer_attribute("tree_rebuilt") != 0};
  }

  std::vector<Blas> blas() const {
    const auto group = root_.open_group("blas");
    const auto table = rows<file::BlasRow>(group, "table", types_.blas);
    const auto geometries = rows<file::GeometryRow>(group, "geometries", types_.geometry);
    const auto triangles = options_.primitives ? rows<Triangle>(group, "triangles", types_.triangle)
                                               : std::vector<Triangle>();
    const auto aabbs =
        options_.primitives ? rows<Box>(group, "aabbs", types_.box) : std::vector<Box>();
    const auto nodes = driver_nodes(group);
    std::vector<Blas> all;
    for (std::size_t i = 0; i < table.size(); ++i) {
      const file::BlasRow& row = table[i];
      Blas b;
      if (options_.primitives) {
        b.triangles = part(group, i, triangles, row.first_triangle, row.triangles);
        b.aabbs = part(group, i, aabbs, row.first_aabb, row.aabbs);
      }
      for (const auto& g : part(group, i, geometries, row.first_geometry, row.geometries)) {
        b.geometries.push_back({g.first, g.count, g.opaque != 0});
      }
      if (options_.driver_nodes) {
        b.driver_nodes = part(group, i, nodes, row.first_node_byte, row.node_bytes);
      }
      all.push_back(std::move(b));
    }
    return all;
  }

  std::vector<Tlas> tlas() const {
    const auto group = root_.open_group("tlas");
    const auto table = rows<file::TlasRow>(group, "table", types_.tlas);
    const auto instances = rows<Instance>(group, "instances", types_.instance);
    const auto nodes = driver_nodes(group);
    std::vector<Tlas> all;
    for (std::size_t i = 0; i < table.size(); ++i) {
      const file::TlasRow& row = table[i];
      Tlas t;
      t.instances = part(group, i, instances, row.first_instance, row.instances);
      if (options_.driver_nodes) {
        t.driver_nodes = part(group, i, nodes, row.first_node_byte, row.node_bytes);
      }
      all.push_back(std::move(t));
    }
    return all;
  }

  std::vector<Shader> shaders() const {
    std::vector<Shader> all;
    for (const auto& row : rows<file::ShaderRow>(root_, "shaders", types_.shader)) {
      all.push_back(
          {row.stage, row.hash, std::string(row.entry, strnlen(row.entry, file::kEntryBytes))});
    }
    return all;
  }

  void work(Workload& w) const {
    w.dispatches = rows<Dispatch>(root_, "dispatches", types_.dispatch);
    w.rays = rows<Ray>(root_, "rays", types_.ray);
    w.driver_hits = rows<Hit>(root_, "driver_hits", types_.hit);
    const std::uint64_t count = root_.rows("candidate_first", H5T_STD_U64LE);
    w.candidate_first.resize(count);
    root_.read_rows("candidate_first", H5T_NATIVE_UINT64, w.candidate_first.data(), count);
    w.candidates = rows<Candidate>(root_, "candidates", types_.candidate);
    w.segments = rows<Segment>(root_, "segments", types_.segment);
  }

 private:
  template <class T>
  std::vector<T> rows(const h5::Location& where, const char* name, const h5::Handle& type) const {
    std::vector<T> all(where.rows(name, type.id()));
    where.read_rows(name, type.id(), all.data(), all.size());
    return all;
  }
  std::vector<std::byte> driver_nodes(const h5::Location& where) const {
    if (!options_.driver_nodes || !where.has("driver_nodes")) {
      return {};
    }
    std::vector<std::byte> all(where.rows("driver_nodes", H5T_STD_U8LE));
    where.read_rows("driver_nodes", H5T_NATIVE_UINT8, all.data(), all.size());
    return all;
  }
  template <class T>
  std::vector<T> part(const h5::Location& where, std::size_t row, const std::vector<T>& all,
                      std::uint64_t first, std::uint64_t count) const {
    if (first > all.size() || count > all.size() - first) {
      where.fail("table", "row " + std::to_string(row) + " names rows " + std::to_string(first) +
                              " to " + std::to_string(first + count) + " of an array of " +
                              std::to_string(all.size()));
    }
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
    return {begin, begin + static_cast<std::ptrdiff_t>(count)};
  }

  const h5::Location& root_;
  const ReadOptions& options_;
  file::Types types_;
};

void check_format(const h5::Location& root, const std::string& name) {
  if (!root.has_attribute("format") || root.text_attribute("format") != file::kFormatName) {
    throw UserError(name + ": an HDF5 file, but not an a2rt workload (attribute 'format' is not '" +
                    file::kFormatName +
                    "'); make one with `a2rt capture` or `a2rt render --capture`");
  }
  const std::uint32_t version = root.integer_attribute("format_version");
  if (version != kWorkloadFormatVersion) {
    throw UserError(name + ": workload format version " + std::to_string(version) +
                    ", this program reads version " + std::to_string(kWorkloadFormatVersion) +
                    (version > kWorkloadFormatVersion ? "; update the program"
                                                      : "; capture the workload again"));
  }
}

}  // namespace

Workload read_workload(const std::filesystem::path& file, const ReadOptions& options) {
  const std::string name = file.string();
  const h5::Quiet quiet;
  check_seal(file);
  try {
    const auto root = h5::open_file(name);
    check_format(root, name);
    const Reader reader(root, options);
    Workload workload;
    workload.provenance = reader.provenance();
    workload.blas = reader.blas();
    workload.tlas = reader.tlas();
    workload.shaders = reader.shaders();
    if (options.rays) {
      reader.work(workload);
    }
    validate(workload, name, {options.primitives, options.rays});
    return workload;
  } catch (const std::bad_alloc&) {
    throw UserError(name + ": claims more data than memory can hold; it is damaged or too large");
  } catch (const std::length_error&) {
    throw UserError(name + ": claims more data than memory can hold; it is damaged or too large");
  }
}

}  // namespace a2rt
