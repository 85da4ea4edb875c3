#include <array>
#include <cstring>
#include <fstream>

#include "a2rt/base/error.h"
#include "a2rt/workload/file.h"
#include "a2rt/workload/validate.h"
#include "file_types.h"
#include "mapped_file.h"
#include "temporary_file.h"

namespace a2rt {
namespace {

using file::Types;

template <class T>
void append(std::vector<T>& all, const std::vector<T>& part) {
  all.insert(all.end(), part.begin(), part.end());
}

class Writer {
 public:
  Writer(const h5::Location& root, const WriteOptions& options) : root_(root), options_(options) {}

  void provenance(const Provenance& p) const {
    const auto group = root_.create_group("provenance");
    group.write_attribute("program", p.program);
    group.write_attribute("driver", p.driver);
    group.write_attribute("command_line", p.command_line);
    group.write_attribute("scene", p.scene);
    group.write_attribute("workload", p.workload);
    group.write_attribute("refused", p.refused);
    group.write_attribute("tree_rebuilt", p.tree_rebuilt ? 1u : 0u);
  }

  void blas(const std::vector<Blas>& all) const {
    std::vector<file::BlasRow> table;
    std::vector<file::GeometryRow> geometries;
    std::vector<Triangle> triangles;
    std::vector<Box> aabbs;
    std::vector<std::byte> nodes;
    for (const Blas& b : all) {
      const std::size_t node_bytes = options_.driver_nodes ? b.driver_nodes.size() : 0;
      table.push_back({triangles.size(), aabbs.size(), geometries.size(), nodes.size(), node_bytes,
                       static_cast<std::uint32_t>(b.triangles.size()),
                       static_cast<std::uint32_t>(b.aabbs.size()),
                       static_cast<std::uint32_t>(b.geometries.size()), 0});
      append(triangles, b.triangles);
      append(aabbs, b.aabbs);
      for (const Geometry& g : b.geometries) {
        geometries.push_back({g.first, g.count, g.opaque ? 1u : 0u});
      }
      if (options_.driver_nodes) {
        append(nodes, b.driver_nodes);
      }
    }
    const auto group = root_.create_group("blas");
    rows(group, "table", types_.blas, table);
    rows(group, "geometries", types_.geometry, geometries);
    rows(group, "triangles", types_.triangle, triangles, options_.deflate);
    rows(group, "aabbs", types_.box, aabbs, options_.deflate);
    bytes(group, nodes);
  }

  void tlas(const std::vector<Tlas>& all) const {
    std::vector<file::TlasRow> table;
    std::vector<Instance> instances;
    std::vector<std::byte> nodes;
    for (const Tlas& t : all) {
      const std::size_t node_bytes = options_.driver_nodes ? t.driver_nodes.size() : 0;
      table.push_back({instances.size(), nodes.size(), node_bytes,
                       static_cast<std::uint32_t>(t.instances.size()), 0});
      append(instances, t.instances);
      if (options_.driver_nodes) {
        append(nodes, t.driver_nodes);
      }
    }
    const auto group = root_.create_group("tlas");
    rows(group, "table", types_.tlas, table);
    rows(group, "instances", types_.instance, instances, options_.deflate);
    bytes(group, nodes);
  }

  void shaders(const std::vector<Shader>& all) const {
    std::vector<file::ShaderRow> table;
    for (const Shader& s : all) {
      file::ShaderRow row{s.hash, s.stage, 0, {}};
      std::memcpy(row.entry, s.entry.data(), std::min(s.entry.size(), file::kEntryBytes));
      table.push_back(row);
    }
    rows(root_, "shaders", types_.shader, table);
  }

  void work(const Workload& w) const {
    rows(root_, "dispatches", types_.dispatch, w.dispatches);
    rows(root_, "rays", types_.ray, w.rays);
    rows(root_, "driver_hits", types_.hit, w.driver_hits);
    root_.write_rows("candidate_first", H5T_STD_U64LE, w.candidate_first.data(),
                     w.candidate_first.size(), sizeof(std::uint64_t), 0);
    rows(root_, "candidates", types_.candidate, w.candidates);
    rows(root_, "segments", types_.segment, w.segments);
  }

 private:
  template <class T>
  void rows(const h5::Location& where, const char* name, const h5::Handle& type,
            const std::vector<T>& all, int deflate = 0) const {
    where.write_rows(name, type.id(), all.data(), all.size(), sizeof(T), deflate);
  }
  void bytes(const h5::Location& where, const std::vector<std::byte>& all) const {
    where.write_rows("driver_nodes", H5T_STD_U8LE, all.data(), all.size(), 1, options_.deflate);
  }

  const h5::Location& root_;
  const WriteOptions& options_;
  Types types_;
};

// Fills the user block once the HDF5 part is complete.
void seal(const std::filesystem::path& path) {
  file::UserBlock block{};
  std::memcpy(block.magic, file::kMagic, sizeof block.magic);
  block.version = 1;
  {
    const MappedFile mapped(path);
    const auto payload = mapped.bytes().subspan(file::kUserBlockBytes);
    block.payload_bytes = payload.size();
    block.payload_hash = file::hash_bytes(payload.data(), payload.size());
  }
  std::array<char, sizeof block> raw;
  std::memcpy(raw.data(), &block, sizeof block);
  std::fstream out(path, std::ios::in | std::ios::out | std::ios::binary);
  if (!out.write(raw.data(), raw.size()).flush()) {
    throw UserError("cannot write '" + path.string() + "'; is the disk full?");
  }
}

}  // namespace

void write_workload(const Workload& workload, const std::filesystem::path& file,
                    const WriteOptions& options) {
  validate(workload, file.string() + " (to be written)");
  const h5::Quiet quiet;
  TemporaryFile temporary(file);
  {
    const auto root = h5::create_file(temporary.path().string(), file::kUserBlockBytes);
    root.write_attribute("format", std::string(file::kFormatName));
    root.write_attribute("format_version", kWorkloadFormatVersion);
    const Writer writer(root, options);
    writer.provenance(workload.provenance);
    writer.blas(workload.blas);
    writer.tlas(workload.tlas);
    writer.shaders(workload.shaders);
    writer.work(workload);
    if (H5Fflush(root.id(), H5F_SCOPE_GLOBAL) < 0) {
      throw UserError("cannot write '" + file.string() + "': " + h5::last_error() +
                      "; is the disk full?");
    }
  }
  seal(temporary.path());
  temporary.commit();
}

}  // namespace a2rt
