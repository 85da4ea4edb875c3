#include "raw_capture.h"

#include <bit>

#include "a2rt/base/error.h"

namespace a2rt::testing {
namespace {

using namespace capture;

template <class T>
void put(Bytes& out, const T* data, std::size_t count) {
  const auto* raw = reinterpret_cast<const std::byte*>(data);
  out.insert(out.end(), raw, raw + count * sizeof(T));
}
template <class T>
void put(Bytes& out, const T& value) {
  put(out, &value, 1);
}
void put_text(Bytes& out, const std::string& text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  put(out, text.data(), text.size());
}
std::uint32_t bits(float value) { return std::bit_cast<std::uint32_t>(value); }

}  // namespace

RawManifest::RawManifest() {
  put(bytes_, kManifestMagic);
  put(bytes_, kFormatVersion);
}

void RawManifest::block(BlockType type, const Bytes& payload) {
  put(bytes_, BlockHeader{static_cast<std::uint32_t>(type), kFormatVersion, payload.size()});
  put(bytes_, payload.data(), payload.size());
}

void RawManifest::driver(const std::string& command_line) {
  Bytes payload;
  put(payload, DriverBlock{1, 2, 3, 4, 1, {}});
  for (const auto& text :
       {std::string("device"), std::string("driver"), std::string("info"), command_line}) {
    put_text(payload, text);
  }
  block(BlockType::kDriver, payload);
}

void RawManifest::shader(std::uint32_t index, Stage stage) {
  Bytes payload;
  put(payload, ShaderBlock{index, static_cast<std::uint32_t>(stage), 77u + index, 1, 1});
  put_text(payload, "main");
  block(BlockType::kShader, payload);
}

void RawManifest::query_site(std::uint32_t shader, std::uint32_t site) {
  Bytes payload;
  put(payload, EffectsBlock{shader, kUsesRayQuery, 1, 0});
  put(payload, SiteBlock{site, 1, 0, 0, 0, 0, 0, 0, 0});
  block(BlockType::kEffects, payload);
}

void RawManifest::blas(std::uint64_t id, std::uint64_t address, const Blas& blas) {
  Bytes payload;
  put(payload, AsBlock{id, address, static_cast<std::uint32_t>(blas.geometries.size()),
                       blas.primitive_count(), 0, 0, blas.driver_nodes.size()});
  for (const Geometry& g : blas.geometries) {
    put(payload, GeometryBlock{blas.procedural() ? 1u : 0u, g.opaque ? 1u : 0u, g.count, 0});
  }
  put(payload, blas.triangles.data(), blas.triangles.size());
  put(payload, blas.aabbs.data(), blas.aabbs.size());
  put(payload, blas.driver_nodes.data(), blas.driver_nodes.size());
  block(BlockType::kBlas, payload);
}

void RawManifest::tlas(std::uint64_t id, std::uint64_t address, const Tlas& tlas,
                       const std::vector<std::uint64_t>& blas_addresses) {
  Bytes payload;
  put(payload, AsBlock{id, address, 1, static_cast<std::uint32_t>(tlas.instances.size()), 0, 0,
                       tlas.driver_nodes.size()});
  for (const Instance& i : tlas.instances) {
    InstanceBlock out{};
    std::memcpy(out.object_to_world, &i.object_to_world, sizeof(Affine));
    std::memcpy(out.world_to_object, &i.world_to_object, sizeof(Affine));
    out.custom_index = i.custom_index;
    out.mask = i.mask;
    out.sbt_offset = i.sbt_offset;
    out.flags = i.flags;
    out.blas_address = i.blas == kNone ? 0 : blas_addresses.at(i.blas);
    put(payload, out);
  }
  put(payload, tlas.driver_nodes.data(), tlas.driver_nodes.size());
  block(BlockType::kTlas, payload);
}

void RawManifest::copy(std::uint64_t from, std::uint64_t to, std::uint64_t id) {
  Bytes payload;
  put(payload, AsCopyBlock{from, to, id});
  block(BlockType::kAsCopy, payload);
}

void RawManifest::destroy(std::uint64_t address) {
  Bytes payload;
  put(payload, AsDestroyedBlock{address});
  block(BlockType::kAsDestroyed, payload);
}

void RawManifest::dispatch(std::uint32_t width, std::uint32_t height, std::uint64_t first_unit,
                           const std::vector<SiteBinding>& sites) {
  Bytes payload;
  put(payload, DispatchBlock{dispatches_, dispatches_, width, height, 1, 0, 0,
                             static_cast<std::uint32_t>(sites.size()), first_unit});
  ++dispatches_;
  put(payload, sites.data(), sites.size());
  block(BlockType::kDispatch, payload);
}

void RawManifest::refused(const std::string& what) {
  Bytes payload;
  put_text(payload, what);
  block(BlockType::kRefused, payload);
}

void RawManifest::end(std::uint64_t units, std::uint64_t lost) {
  Bytes payload;
  put(payload, EndBlock{units, lost});
  block(BlockType::kEnd, payload);
}

RawRecords& RawRecords::by(Stage stage, std::uint32_t shader, std::uint32_t launch) {
  stage_ = stage;
  shader_ = shader;
  launch_ = launch;
  query_.reset();
  ordinals_.resize(std::max<std::size_t>(ordinals_.size(), launch + 1));
  return *this;
}

void RawRecords::unit(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  const std::uint32_t words[4] = {a, b, c, d};
  put(bytes_, words, 4);
}

void RawRecords::head(RecordKind kind) {
  const bool names =
      query_ && (kind == RecordKind::kQueryStep || kind == RecordKind::kQueryVerdict);
  unit(static_cast<std::uint32_t>(kind) | static_cast<std::uint32_t>(stage_) << 8 | shader_ << 16,
       launch_, dispatch_, names ? *query_ + 1 : ordinals_.at(launch_));
}

RawRecords& RawRecords::of_query(std::uint32_t ordinal) {
  query_ = ordinal;
  return *this;
}

void RawRecords::hit_units(const Hit& h, std::uint32_t last) {
  unit(h.kind, bits(h.t), h.primitive, h.instance);
  unit(h.geometry, 0, last, 0);
}

RawRecords& RawRecords::ray(const Ray& r, std::uint32_t site, bool overridden) {
  head(RecordKind::kRay);
  ++ordinals_[launch_];
  unit(bits(r.origin.x), bits(r.origin.y), bits(r.origin.z), bits(r.tmin));
  unit(bits(r.dir.x), bits(r.dir.y), bits(r.dir.z), bits(r.tmax));
  unit(r.flags & kVulkanRayFlags, r.mask | r.sbt << 8, site, overridden ? 1 : 0);
  unit(11, 0, 0, 0);
  unit(0, 0, 0, 0);
  return *this;
}
RawRecords& RawRecords::hit(const Hit& h) {
  head(RecordKind::kHit);
  hit_units(h, 0);
  return *this;
}
RawRecords& RawRecords::miss() {
  head(RecordKind::kMiss);
  return *this;
}
RawRecords& RawRecords::any_hit(const Hit& candidate, AnyHitVerdict verdict) {
  head(RecordKind::kAnyHit);
  hit_units(candidate, static_cast<std::uint32_t>(verdict));
  return *this;
}
RawRecords& RawRecords::report(const Hit& candidate, bool accepted) {
  head(RecordKind::kReport);
  hit_units(candidate, accepted ? 1 : 0);
  return *this;
}
RawRecords& RawRecords::segment(std::uint32_t alu) {
  head(RecordKind::kSegment);
  unit(alu, 0, 0, 0);
  unit(0, 0, 0, 0);
  return *this;
}
RawRecords& RawRecords::end(std::uint32_t alu) {
  head(RecordKind::kEnd);
  unit(alu, 0, 0, 0);
  unit(0, 0, 0, 0);
  return *this;
}
RawRecords& RawRecords::step(const Hit& committed, bool more) {
  head(RecordKind::kQueryStep);
  const bool any = committed.state != HitState::kMiss;
  const bool front = committed.kind == 0xFE;
  const bool triangle = committed.kind == 0xFE || committed.kind == 0xFF;
  unit(!any ? 0 : (triangle ? 1 : 2), bits(committed.t), any ? committed.primitive : 0,
       any ? committed.instance : 0);
  unit(any ? committed.geometry : 0, 0, more ? 1 : 0, front ? 1 : 0);
  return *this;
}
RawRecords& RawRecords::query_verdict(const Hit& candidate, bool generated, AnyHitVerdict verdict) {
  head(RecordKind::kQueryVerdict);
  unit(generated ? 1 : 0, bits(candidate.t), candidate.primitive, candidate.instance);
  unit(candidate.geometry, 0, static_cast<std::uint32_t>(verdict), 0);
  return *this;
}

Workload import_raw(const RawManifest& manifest, const RawRecords& records,
                    const ImportOptions& options, ImportReport* report) {
  ImportReport own;
  return import_capture(manifest.bytes(), records.bytes(), options,
                        report == nullptr ? own : *report);
}

std::string import_error(std::span<const std::byte> manifest, std::span<const std::byte> records,
                         const ImportOptions& options) {
  try {
    ImportReport report;
    import_capture(manifest, records, options, report);
  } catch (const UserError& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace a2rt::testing
